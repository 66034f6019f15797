# livecap_precompiled(TARGET KIND HEADERS header... LIBS target...): the headers that take longest to read are read once
# for all targets of a KIND, which share their compile options. Only headers of others: what ours forget to include shows
# with -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON.
function(livecap_precompiled target kind)
  if(CMAKE_DISABLE_PRECOMPILE_HEADERS)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "HEADERS;LIBS" ${ARGN})
  set(read livecap_precompiled_${kind})
  if(NOT TARGET ${read})
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/precompiled.cpp CONTENT "")
    add_library(${read} OBJECT EXCLUDE_FROM_ALL ${PROJECT_BINARY_DIR}/precompiled.cpp)
    get_target_property(options ${target} COMPILE_OPTIONS)
    if(options)
      target_compile_options(${read} PRIVATE ${options})
    endif()
    get_target_property(type ${target} TYPE)
    if(type STREQUAL "EXECUTABLE")
      target_compile_options(${read} PRIVATE ${CMAKE_CXX_COMPILE_OPTIONS_PIE})
    endif()
    target_link_libraries(${read} PRIVATE Eigen3::Eigen ${ARG_LIBS})
    target_precompile_headers(${read} PRIVATE <algorithm> <array> <cmath> <filesystem> <functional> <map> <memory>
      <optional> <string> <unordered_map> <vector> <Eigen/Dense> ${ARG_HEADERS})
  endif()
  target_precompile_headers(${target} REUSE_FROM ${read})
  # Where a macro differs GCC refuses what was read, and reads the headers again: slower, but no reason to warn.
  set_target_properties(${target} PROPERTIES PCH_WARN_INVALID OFF)
  target_include_directories(${target} SYSTEM PRIVATE
    $<BUILD_INTERFACE:$<TARGET_PROPERTY:Eigen3::Eigen,INTERFACE_INCLUDE_DIRECTORIES>>)
endfunction()
