target_link_libraries(test_nn PRIVATE opencv_core opencv_imgproc opencv_imgcodecs opencv_dnn)
target_compile_definitions(test_nn PRIVATE LIVECAP_SOURCE_MODELS="${PROJECT_SOURCE_DIR}/models")
# tflite_writer.h writes with the tables that the importer reads with.
target_include_directories(test_nn SYSTEM PRIVATE
  $<TARGET_PROPERTY:livecap_nn,BINARY_DIR>/generated ${FLATBUFFERS_INCLUDE_DIR})
