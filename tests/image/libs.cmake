# OpenCV's own projection is what undistortion is checked against; the turn of pixels is tested below the public header.
find_package(OpenCV 4 REQUIRED COMPONENTS core calib3d)
target_link_libraries(test_image PRIVATE opencv_core opencv_calib3d)
