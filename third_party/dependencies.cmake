# Every foreign dependency, found here and nowhere else. No foreign code is kept in this repository.
#
# name            Debian 12 package                      version  licence        why
# OpenCL          ocl-icd-opencl-dev, opencl-headers     1.2+     Apache/BSD     the compute interface
# PoCL            pocl-opencl-icd (run time only)        3.1      MIT            OpenCL on any CPU
# Eigen           libeigen3-dev                          3.4      MPL-2.0        small dense algebra, QR, reference solvers
# OpenCV          libopencv-dev                          4.6      Apache-2.0     background model, distance transform, calibration boards, edges
# FFmpeg          libav{codec,device,format,util}-dev, libswscale-dev  5.1  LGPL/GPL  video and webcams in, video out, every damaged frame reported; of libavdevice only the library, at run time
# libspng         libspng-dev                            0.7.3    BSD-2-Clause   PNG files
# libjpeg-turbo   libjpeg-dev                            2.1.5    IJG/BSD        JPEG files (OpenCV reads both, but its imgcodecs loads 118 libraries)
# CLBlast         libclblast-dev                         1.5.3    Apache-2.0     optional: what bench_pointwise compares convolutions with
# OpenMesh        libopenmesh-dev                        9.0      BSD-3-Clause   meshes whose edges are collapsed, split and flipped
# TinyGLTF        libtinygltf-dev                        2.7      MIT            GLB parsing and writing
# nlohmann json   nlohmann-json3-dev                     3.11     MIT            JSON files
# FlatBuffers     libflatbuffers-dev, flatbuffers-compiler  2.0.8  Apache-2.0  verified reading of .tflite files
# CLI11           libcli11-dev                           2.1      BSD-3-Clause   command line
# toml++          libtomlplusplus-dev                    3.3      MIT            TOML files with options (--config)
# GoogleTest      libgtest-dev, libgmock-dev             1.12     BSD-3-Clause   tests
# Google Benchmark  libbenchmark-dev                     1.7      Apache-2.0     optional: tests/bench
# Ceres           libceres-dev                           2.1      BSD-3-Clause   tests only: a trusted solver to compare with
find_package(OpenCL 1.2 REQUIRED)
find_package(Threads REQUIRED)
find_package(Eigen3 3.3 REQUIRED NO_MODULE)
find_package(OpenCV 4.5.4 REQUIRED COMPONENTS core imgproc video calib3d aruco)
find_package(nlohmann_json 3 REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(FFMPEG REQUIRED IMPORTED_TARGET libavformat libavcodec libavutil libswscale)
pkg_check_modules(SPNG REQUIRED IMPORTED_TARGET spng)
find_package(JPEG REQUIRED)
find_path(OPENMESH_INCLUDE_DIR OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh REQUIRED)
find_library(OPENMESH_CORE_LIBRARY OpenMeshCore REQUIRED)
find_library(OPENMESH_TOOLS_LIBRARY OpenMeshTools REQUIRED)
find_path(FLATBUFFERS_INCLUDE_DIR flatbuffers/flatbuffers.h REQUIRED)
find_program(FLATC_PROGRAM flatc REQUIRED)
find_path(TINYGLTF_INCLUDE_DIR tiny_gltf.h REQUIRED)
find_library(TINYGLTF_LIBRARY tinygltf REQUIRED)
find_path(CLI11_INCLUDE_DIR CLI/CLI.hpp REQUIRED)
find_path(TOMLPLUSPLUS_INCLUDE_DIR toml++/toml.h REQUIRED)
find_path(CLBLAST_INCLUDE_DIR clblast.h)
find_library(CLBLAST_LIBRARY clblast)
if(LIVECAP_BUILD_TESTS)
  find_package(GTest REQUIRED)
  find_package(benchmark QUIET)
endif()

add_library(livecap_openmesh INTERFACE)
target_include_directories(livecap_openmesh SYSTEM INTERFACE ${OPENMESH_INCLUDE_DIR})
target_link_libraries(livecap_openmesh INTERFACE ${OPENMESH_TOOLS_LIBRARY} ${OPENMESH_CORE_LIBRARY})
target_compile_definitions(livecap_openmesh INTERFACE _USE_MATH_DEFINES)
add_library(livecap_tinygltf INTERFACE)
target_include_directories(livecap_tinygltf SYSTEM INTERFACE ${TINYGLTF_INCLUDE_DIR})
target_link_libraries(livecap_tinygltf INTERFACE ${TINYGLTF_LIBRARY})
