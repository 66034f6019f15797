#include "c_api/embed.h"

#include <stdlib.h>

static float* copied(const void* from, int n_floats) {
  const size_t bytes = (size_t)n_floats * sizeof(float);
  float* to = from ? malloc(bytes) : NULL;
  if (to) memcpy(to, from, bytes);
  return to;
}

static void keep(const embed_run* run, const livecap_result* result, embed_result* results, int* n) {
  embed_result* own = &results[*n];
  if (!result || *n == kEmbedMostResults) return;
  own->index = result->index;
  own->time_s = result->time_s;
  own->status = result->status;
  own->is_tracked = result->is_tracked;
  own->score = result->score;
  own->iou = result->iou;
  own->bones = copied(result->bones, 7 * run->n_bones);
  own->angles_rad = copied(result->angles_rad, run->n_angles);
  own->vertices_m = copied(result->vertices_m, 3 * run->n_vertices);
  ++*n;
}

static void hear(const livecap_result* result, void* user) {
  embed_run* run = user;
  keep(run, result, run->heard, &run->n_heard);
}

livecap_error embed(const livecap_options* options, const livecap_picture* pictures, int n_pictures, embed_run* run) {
  livecap_options mine = *options;
  livecap_capture* capture = NULL;
  const livecap_actor* actor;
  const livecap_result* held = NULL; /* kept as late as can be: it lasts until the next poll */
  livecap_error error;
  int i;

  memset(run, 0, sizeof *run);
  mine.on_result = hear;
  mine.user = run;
  error = livecap_open(&mine, &capture);
  if (error != LIVECAP_OK) return error;
  actor = livecap_get_actor(capture);
  run->n_bones = actor->n_bones;
  run->n_angles = actor->n_angles;
  run->n_vertices = actor->n_vertices;
  for (i = 0; i < n_pictures && error == LIVECAP_OK; ++i) {
    error = livecap_push(capture, &pictures[i]);
    keep(run, held, run->polled, &run->n_polled);
    held = livecap_poll(capture);
  }
  run->close_error = livecap_close(capture);
  do {
    keep(run, held, run->polled, &run->n_polled);
    held = livecap_poll(capture);
  } while (held != NULL);
  livecap_free(capture);
  return error;
}

static void free_results(embed_result* results, int n) {
  int i;
  for (i = 0; i < n; ++i) {
    free(results[i].bones);
    free(results[i].angles_rad);
    free(results[i].vertices_m);
  }
}

void embed_free(embed_run* run) {
  free_results(run->heard, run->n_heard);
  free_results(run->polled, run->n_polled);
}
