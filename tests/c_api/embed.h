// A program in C that captures pictures and keeps everything that it is told.
#pragma once

#include "livecap/livecap.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { kEmbedMostResults = 64 };

// A result with memory of its own. Each array is NULL where nobody was tracked.
typedef struct embed_result {
  int64_t index;
  double time_s;
  int32_t status, is_tracked;
  double score, iou;
  float* bones;       // [7*n_bones]
  float* angles_rad;  // [n_angles]
  float* vertices_m;  // [3*n_vertices]
} embed_result;

typedef struct embed_run {
  int n_bones, n_angles, n_vertices;  // of the actor
  int n_heard;
  embed_result heard[kEmbedMostResults];  // of on_result
  int n_polled;
  embed_result polled[kEmbedMostResults];
  livecap_error close_error;
} embed_run;

// Opens, pushes every picture and polls after each, closes, polls what is left and frees; on_result and user of the
// options are replaced. The first code that is not LIVECAP_OK. embed_free() frees *run in either case.
livecap_error embed(const livecap_options* options, const livecap_picture* pictures, int n_pictures, embed_run* run);

void embed_free(embed_run* run);

#ifdef __cplusplus
}
#endif
