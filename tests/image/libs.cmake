# OpenCV is what files of pictures, undistortion, pieces and the distance field are checked against; the turn of pixels is tested below the public header.
find_package(OpenCV 4 REQUIRED COMPONENTS core imgproc imgcodecs calib3d)
target_link_libraries(test_image PRIVATE opencv_core opencv_imgproc opencv_imgcodecs opencv_calib3d)
