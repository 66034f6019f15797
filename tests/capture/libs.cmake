target_link_libraries(test_capture PRIVATE livecap_eval nlohmann_json::nlohmann_json)
target_compile_definitions(test_capture PRIVATE LIVECAP_SOURCE_MODELS="${PROJECT_SOURCE_DIR}/models")
set(slow_units components determinism live presence robustness)
