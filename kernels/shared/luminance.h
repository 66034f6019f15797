// How much of a colour's brightness its red, green and blue are (ITU-R BT.601). On the host: src/base/luminance.h.
#ifndef LC_SHARED_LUMINANCE_H
#define LC_SHARED_LUMINANCE_H

#define LC_RED_LUMINANCE 0.299f
#define LC_GREEN_LUMINANCE 0.587f
#define LC_BLUE_LUMINANCE 0.114f

static inline float luminance(float r, float g, float b) {
  return LC_RED_LUMINANCE * r + LC_GREEN_LUMINANCE * g + LC_BLUE_LUMINANCE * b;
}

#endif
