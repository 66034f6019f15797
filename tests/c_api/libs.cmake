target_sources(test_c_api PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/c_api/embed.c)
set_source_files_properties(${CMAKE_CURRENT_SOURCE_DIR}/c_api/embed.c PROPERTIES
  COMPILE_OPTIONS "-pedantic;-Wall;-Wextra;-Werror")
set_target_properties(test_c_api PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF
  DISABLE_PRECOMPILE_HEADERS ON)  # those are C++
# The rooms twice, as in a program that has C++ of its own: inside the shared library, and beside it for comparison.
target_link_libraries(test_c_api PRIVATE livecap_capture)
target_compile_definitions(test_c_api PRIVATE LIVECAP_SOURCE_MODELS="${PROJECT_SOURCE_DIR}/models")
set(slow_units calls embed)
