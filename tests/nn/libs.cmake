target_link_libraries(test_nn PRIVATE opencv_core opencv_imgproc opencv_imgcodecs opencv_dnn)
target_compile_definitions(test_nn PRIVATE LIVECAP_SOURCE_MODELS="${PROJECT_SOURCE_DIR}/models")
