/* Somebody else's program in C99: the installed shared library answers, and says what is missing by its name. With an
   argument, that of a folder, the network weights are expected there and to be broken. */
#include <livecap/livecap.h>
#include <stdio.h>
#include <string.h>

static int refused(livecap_error got, livecap_error expected, const char* what) {
  printf("refused (%d): %s\n", (int)got, livecap_last_error());
  return got != expected || strstr(livecap_last_error(), what) == NULL;
}

int main(int argc, char** argv) {
  livecap_options options;
  livecap_capture* capture = NULL;
  int wrong = 0;
  livecap_options_init(&options);
  wrong += refused(livecap_load_camera("no_such_camera.json", &options.camera), LIVECAP_IO_ERROR, "no_such_camera");
  wrong += livecap_camera_from_fov(640, 480, 60, &options.camera) != LIVECAP_OK;
  options.actor = "no_such_actor.glb";
  wrong += refused(livecap_open(&options, &capture), LIVECAP_IO_ERROR, options.actor);
  if (argc == 2) {
    options.actor = "builtin:trousers";
    options.model = "lite";
    wrong += refused(livecap_open(&options, &capture), LIVECAP_IO_ERROR, argv[1]);
  }
  livecap_free(capture);
  return wrong;
}
