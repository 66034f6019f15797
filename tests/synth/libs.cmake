target_link_libraries(test_synth PRIVATE livecap_actor livecap_tinygltf nlohmann_json::nlohmann_json opencv_core opencv_imgproc
  opencv_imgcodecs)
set(slow_units scenario)
