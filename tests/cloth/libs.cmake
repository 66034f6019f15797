# The built-in skirt.
target_link_libraries(test_cloth PRIVATE livecap_synth)
