find_package(Ceres REQUIRED)
target_link_libraries(test_pose PRIVATE Ceres::ceres livecap_synth)
