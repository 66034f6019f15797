// The kernels that match the actor with the picture as one program, but that which does it all at once (see_actor.cl).
#include "match/blur.cl"
#include "match/camera_picture.cl"
#include "match/light.cl"
#include "match/normalise.cl"
#include "match/patch_match.cl"
#include "match/skin_shading.cl"
#include "match/textured_actor.cl"
