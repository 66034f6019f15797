# Installs the program, the static libraries, the shared library of the C interface, the public headers, and the package
# files behind find_package(livecap) and pkg-config. Who embeds the library links livecap::livecap from C++, else
# livecap::livecap_c.
include(CMakePackageConfigHelpers)

add_library(livecap_api INTERFACE)
set_target_properties(livecap_api PROPERTIES EXPORT_NAME livecap)
target_link_libraries(livecap_api INTERFACE livecap_capture)
add_library(livecap::livecap ALIAS livecap_api)

get_property(rooms GLOBAL PROPERTY LIVECAP_ROOMS)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/livecap)
install(TARGETS livecap_api ${rooms} livecap_openmesh livecap_tinygltf EXPORT livecapTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/livecap)
install(TARGETS livecap_c_api EXPORT livecapTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT livecapTargets NAMESPACE livecap:: DESTINATION ${package_dir})
install(DIRECTORY include/livecap DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN *.h)
# The network weights, when tools/setup.sh has fetched them; program and shared library look for them there.
install(DIRECTORY models/ DESTINATION ${CMAKE_INSTALL_DATADIR}/livecap/models OPTIONAL FILES_MATCHING PATTERN *.tflite)
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR})

configure_package_config_file(cmake/livecapConfig.cmake.in ${PROJECT_BINARY_DIR}/livecapConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/livecapConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/livecapConfig.cmake ${PROJECT_BINARY_DIR}/livecapConfigVersion.cmake
  DESTINATION ${package_dir})

# Relative to itself, because --prefix may come later than this.
set(pc_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH LIVECAP_PREFIX_FROM_PC /${pc_dir} /)
string(REGEX REPLACE "/$" "" LIVECAP_PREFIX_FROM_PC ${LIVECAP_PREFIX_FROM_PC})
configure_file(cmake/livecap.pc.in ${PROJECT_BINARY_DIR}/livecap.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/livecap.pc DESTINATION ${pc_dir})
