# OpenCV's GaussianBlur and Eigen's sparse solvers are the independent formulas of this room's tests.
target_include_directories(test_surface PRIVATE ${OpenCV_INCLUDE_DIRS})
target_link_libraries(test_surface PRIVATE opencv_core opencv_imgproc Eigen3::Eigen)
