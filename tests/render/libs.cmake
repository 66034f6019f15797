# OpenCV's projectPoints is the independent projection of viewpoint_test.
target_link_libraries(test_render PRIVATE livecap_synth opencv_calib3d opencv_imgcodecs)
