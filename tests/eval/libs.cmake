# OpenCV's projectPoints is the independent projection of mask_raster_test.
target_link_libraries(test_eval PRIVATE opencv_calib3d)
