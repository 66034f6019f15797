target_link_libraries(test_detect PRIVATE opencv_core opencv_imgproc opencv_imgcodecs)
target_compile_definitions(test_detect PRIVATE LIVECAP_SOURCE_MODELS="${PROJECT_SOURCE_DIR}/models")
