// How a colour looks in a light.
#ifndef LC_MATCH_LIT_H
#define LC_MATCH_LIT_H

// Whatever their colour, surfaces that are no metal also reflect so much of the light around them as a mirror does:
// black shoes hardly show the shading that white ones do. Of linear light, of what falls on them.
#define MIRRORED 0.04f

// What is left of shading on a colour, 0..1. Coded brightness 0..1; its square is nearly linear.
#define MATT_SHARE(color) ((color) * (color) / ((color) * (color) + MIRRORED))

// And so how bright it looks; shade: see light.cl.
#define LIT(color, shade) ((color) * (1.0f + MATT_SHARE(color) * ((shade)-1.0f)))

#endif
