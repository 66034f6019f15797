# Installs the program, the static libraries, the public headers and the package files behind find_package(livecap).
# Who embeds the library links livecap::livecap.
include(CMakePackageConfigHelpers)

add_library(livecap_api INTERFACE)
set_target_properties(livecap_api PROPERTIES EXPORT_NAME livecap)
target_link_libraries(livecap_api INTERFACE livecap_capture)
add_library(livecap::livecap ALIAS livecap_api)

get_property(rooms GLOBAL PROPERTY LIVECAP_ROOMS)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/livecap)
install(TARGETS livecap_api ${rooms} livecap_openmesh livecap_tinygltf EXPORT livecapTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/livecap)
install(EXPORT livecapTargets NAMESPACE livecap:: DESTINATION ${package_dir})
install(DIRECTORY include/livecap DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN *.h)
# The network weights, when tools/setup.sh has fetched them; the program looks for them there.
install(DIRECTORY models/ DESTINATION ${CMAKE_INSTALL_DATADIR}/livecap/models OPTIONAL FILES_MATCHING PATTERN *.tflite)
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})

configure_package_config_file(cmake/livecapConfig.cmake.in ${PROJECT_BINARY_DIR}/livecapConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/livecapConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/livecapConfig.cmake ${PROJECT_BINARY_DIR}/livecapConfigVersion.cmake
  DESTINATION ${package_dir})
