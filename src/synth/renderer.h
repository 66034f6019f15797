// The camera of the synthetic sequences: an indoor room, a textured person in it, a shadow on the floor, and a sensor
// with blur and noise. A plain CPU renderer that shares nothing with the tracker's rasteriser. Colours are linear
// inside.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "base/image_rgb.h"
#include "livecap/camera.h"
#include "synth/actor_model.h"

namespace livecap::synth {

using Color = Eigen::Vector3f;  // linear RGB

// Where the camera stands. Room frame: mm, origin on the floor at the actor's place, Y up, +Z towards the camera.
struct View {
  Camera camera;  // without distortion
  Eigen::Matrix3d camera_from_room_rotation;
  Vec3 camera_from_room_translation;

  Vec3 to_camera(const Vec3& room) const { return camera_from_room_rotation * room + camera_from_room_translation; }
};

// Light of the room: a large lamp and what the walls return.
struct Lighting {
  Vec3 key_direction = Vec3(0.45, 0.80, 0.62).normalized();  // towards the lamp
  Vec3 fill_direction = Vec3(-0.7, 0.25, 0.6).normalized();
  Color key = {0.72f, 0.69f, 0.64f};
  Color fill = {0.13f, 0.14f, 0.17f};
  Color ambient = {0.36f, 0.37f, 0.39f};

  Color shade(const Color& albedo, const Vec3& normal, double key_visible = 1, double ambient_visible = 1) const;
};

// Something upright between the lamp and the room: a soft-edged band without the lamp's light.
struct MovingShadow {
  double x_mm = 0;  // where the band's middle meets the floor
  double half_width_mm = 0;
  double strength = 0;  // share of the lamp's light that is missing in the middle

  // Share of the lamp's light that reaches the point whose ray from the lamp meets the floor at lamp_x (see below).
  double key_visible(double lamp_x) const;
};

// x of where the ray from the lamp through p meets the floor.
inline double lamp_x(const Lighting& lighting, const Vec3& p) {
  return p.x() - p.y() * lighting.key_direction.x() / lighting.key_direction.y();
}

// The empty room as the camera sees it.
struct Plate {
  std::vector<Color> lit;      // [width*height]
  std::vector<Color> no_key;   // [width*height] the same without the lamp: what a full shadow leaves
  std::vector<float> floor_x;  // [width*height] mm, room frame; NaN where the pixel does not show the floor
  std::vector<float> floor_z;
  std::vector<float> lamp_x;  // [width*height] mm, see lamp_x()
};

// A room painted in two colours: what is behind the upper part of a person at the actor's place, and the rest.
struct Wallpaper {
  Color upper, lower;
  double border_mm = 0;  // height above the floor at the actor's place
};

Plate render_plate(const View& view, const Lighting& lighting, uint64_t seed,
                   const std::optional<Wallpaper>& wallpaper = {});

// The person alone: sums over the covered samples of each pixel.
struct PersonLayer {
  std::vector<Color> color;      // [width*height] sum over covered samples
  std::vector<uint8_t> covered;  // [width*height] of kSamples
};

inline constexpr int kSamplesPerSide = 2;
inline constexpr int kSamples = kSamplesPerSide * kSamplesPerSide;

// vertices: welded, room frame.
PersonLayer render_person(const View& view, const Lighting& lighting, const ActorModel& actor,
                          const std::vector<Vec3>& vertices, const MovingShadow& moving = {});

// Takes the moving shadow's light away from the plate.
void darken(const MovingShadow& moving, Plate& plate);

// Darkens the floor of the plate below and behind the person.
void add_shadow(const Lighting& lighting, const ActorModel& actor, const std::vector<Vec3>& vertices, Plate& plate);

struct Sensor {
  double blur_px = 0;
  double noise = 0;  // standard deviation, 8-bit levels
  double gain = 1;
  uint64_t seed = 0;
};

// Linear picture -> what the camera delivers (sRGB, 8 bit).
ImageRgb expose(const std::vector<Color>& linear, int width, int height, const Sensor& sensor);

float linear_from_srgb(float encoded);

}  // namespace livecap::synth
