# livecap_embed_kernels(OUT_VAR): generates one .cpp that holds every file below kernels/ as a byte array, so that
# the program needs no kernel folder at run time.
function(livecap_embed_kernels out_var)
  set(root ${PROJECT_SOURCE_DIR}/kernels)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS RELATIVE ${root} ${root}/*.cl ${root}/*.h)
  list(SORT files)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/embedded_kernels.cpp)
  set(depends)
  foreach(file ${files})
    list(APPEND depends ${root}/${file})
  endforeach()
  string(REPLACE ";" "," joined "${files}")
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DROOT=${root} -DFILES=${joined} -DOUTPUT=${output}
            -P ${PROJECT_SOURCE_DIR}/cmake/write_embedded_kernels.cmake
    DEPENDS ${depends} ${PROJECT_SOURCE_DIR}/cmake/write_embedded_kernels.cmake
    COMMENT "Embedding OpenCL kernels" VERBATIM)
  set(${out_var} ${output} PARENT_SCOPE)
endfunction()
