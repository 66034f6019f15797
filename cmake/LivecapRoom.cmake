# livecap_warnings(TARGET): the warnings our own code is free of; errors with LIVECAP_WERROR.
function(livecap_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wno-unknown-pragmas
    # GCC 12 sees an overlapping copy in every "text" + std::string (its bug 105651, gone in 13).
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>
    # Files compiled together count as headers, whose types of unnamed namespaces it warns about.
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${CMAKE_UNITY_BUILD}>>:-Wno-subobject-linkage>
    $<$<BOOL:${LIVECAP_WERROR}>:-Werror>)
endfunction()

# livecap_room(NAME DEPENDS room... LIBS target... PRIVATE_LIBS target...)
#
# One static library per room from all its .cpp files: target livecap_NAME. DEPENDS names the rooms it may
# include; LIBS are third-party targets its headers need, PRIVATE_LIBS those only its sources need.
function(livecap_room name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;LIBS;PRIVATE_LIBS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  add_library(livecap_${name} STATIC ${sources})
  target_include_directories(livecap_${name}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
           $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
           $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${PROJECT_SOURCE_DIR}/kernels)
  livecap_warnings(livecap_${name})
  livecap_precompiled(livecap_${name} rooms)
  foreach(room ${ARG_DEPENDS})
    target_link_libraries(livecap_${name} PUBLIC livecap_${room})
  endforeach()
  target_link_libraries(livecap_${name} PUBLIC ${ARG_LIBS} PRIVATE ${ARG_PRIVATE_LIBS})
  set_property(GLOBAL APPEND PROPERTY LIVECAP_ROOMS livecap_${name})
endfunction()
