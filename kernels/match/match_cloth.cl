// The kernels that match cloth in the surface stage: those of match.cl, of a program of their own, since both stages
// run at the same time (src/ocl/program_twins.h).
#include "match/blur.cl"
#include "match/camera_picture.cl"
#include "match/light.cl"
#include "match/match_anew.cl"
#include "match/match_behind.cl"
#include "match/normalise.cl"
#include "match/patch_match.cl"
#include "match/textured_actor.cl"
