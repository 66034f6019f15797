target_link_libraries(test_detect PRIVATE opencv_core opencv_imgproc opencv_imgcodecs Eigen3::Eigen)
target_compile_definitions(test_detect PRIVATE LIVECAP_SOURCE_MODELS="${PROJECT_SOURCE_DIR}/models")
