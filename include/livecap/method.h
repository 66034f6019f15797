// What every capture needs to be told, whether of a video (livecap/capture.h) or of pictures as they come
// (livecap/live.h): who is captured, with which parts of the method, on which devices.
#pragma once

#include <string>
#include <vector>

namespace livecap {

struct MethodOptions {
  std::string actor;                 // actor.glb or "builtin:skirt", "builtin:trousers"
  double height_mm = 0;              // > 0: the actor is scaled to this height
  std::string model = "full";        // lite | full | heavy | path of a .tflite file
  bool surface = true;               // false: stage I only
  std::vector<std::string> without;  // energy terms and components switched off (docs/conventions.md)
  double rigidity = 0;               // > 0: material weight s_ij of the whole surface, instead of each label's
  std::string cnn_device;            // selectors, see `livecap devices`; empty: chosen
  std::string solver_device;

  // Throws ConfigError naming the option.
  void validate() const;
};

}  // namespace livecap
