// livecap actor import: a published template (Skeletool files) as an actor.glb, and its motion as a truth folder.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "acquire/import_template.h"
#include "acquire/template_truth.h"
#include "base/log.h"
#include "base/require_writable.h"
#include "base/text.h"
#include "cmd_actor.h"
#include "livecap/error.h"
#include "progress.h"
#include "report/actor_report.h"
#include "value_checks.h"

namespace livecap::tools {
namespace {

namespace fs = std::filesystem;

struct ImportCommand {
  acquire::TemplateFiles files;
  acquire::MotionFiles motion;
  std::string truth;  // folder; empty: none
  std::string out;
};

std::vector<InputFile> inputs_of(const ImportCommand& command) {
  const acquire::TemplateFiles& files = command.files;
  return {{"--skeleton", files.skeleton},
          {"--skin", files.skin},
          {"--mesh", files.mesh},
          {"--texture", files.texture},
          {"--labels", files.labels},
          {"--bones", files.bones},
          {"--motion", command.motion.motion},
          {"--cameras", command.motion.cameras}};
}

// Makes the truth folder. Throws IoError or ConfigError where it cannot be written or an input lies in it.
void prepare_truth(const ImportCommand& command, const acquire::TemplateMotion& motion) {
  std::error_code error;
  fs::create_directories(command.truth, error);
  if (error) throw IoError(command.truth + ": cannot be created: " + error.message());
  const std::vector<fs::path> files = acquire::template_truth_files(command.truth, motion);
  for (const fs::path& file : files) require_writable(file);
  require_apart(inputs_of(command), files);
}

void write_truth(const ImportCommand& command, const acquire::ImportedTemplate& imported, const Actor& actor,
                 const acquire::TemplateMotion& motion) {
  catch_interrupt();
  Progress progress("truth");
  const acquire::TruthSummary summary =
      acquire::write_template_truth(imported, actor, motion, command.truth, [&](int done, int total) {
        progress.update(done, total);
        return !interrupted();
      });
  progress.update(motion.n_frames, motion.n_frames);
  progress.finish();
  if (!motion.camera)
    log_warning("no --cameras: the motion is taken to be in the camera's frame (mm; x right, y down, z forward)");
  if (summary.n_outside > 0)
    log_warning(
        format("in %d of %d frames the root is not in the camera's picture", summary.n_outside, summary.n_known));
  std::printf(
      "%s: %d frames, the motion's %d to %d, %d of them known%s\n", command.truth.c_str(), motion.n_frames,
      motion.first, motion.first + motion.n_frames - 1, summary.n_known,
      motion.camera ? ("; camera " + motion.camera->name + " is " + command.truth + "/camera.json").c_str() : "");
}

int import_actor(const ImportCommand& command) {
  if (command.motion.motion.empty() != command.truth.empty())
    throw ConfigError("--motion and --truth: the motion of the template and the folder for it, give both or neither");
  require_actor_output(command.out, inputs_of(command));
  acquire::ImportedTemplate imported = acquire::import_template(command.files, fs::path(command.out).stem().string());
  acquire::TemplateMotion motion;
  if (!command.truth.empty()) {
    motion = acquire::read_template_motion(command.motion, imported.skeleton);
    prepare_truth(command, motion);
  }
  const std::string bytes = meshing::actor_glb(imported.actor);
  const Actor actor = load_actor_bytes(bytes, command.out);
  write_file_atomically(command.out, bytes);
  for (const std::string& note : imported.notes) log_warning(note);
  const std::string facts = format("%d vertices, %zu of %d bones are joints of the rig", actor.n_vertices(),
                                   imported.actor.rig.size(), imported.skeleton.skeleton.n_bones());
  const fs::path report = fs::path(command.out).replace_extension(".html");
  write_file_atomically(report, actor_report_html(actor, {imported.actor.name, {facts}, imported.notes}));
  std::printf("%s: %s; see %s\n", command.out.c_str(), facts.c_str(), report.c_str());
  if (!command.truth.empty()) write_truth(command, imported, actor, motion);
  return kExitOk;
}

}  // namespace

void add_actor_import_command(CLI::App& actor, Action& action) {
  auto options = std::make_shared<ImportCommand>();
  acquire::TemplateFiles& files = options->files;
  acquire::MotionFiles& motion = options->motion;
  CLI::App* command =
      actor.add_subcommand("import", "make an actor.glb of a published template: Skeletool skeleton, skin and mesh");
  command->fallthrough();
  command->add_option("--skeleton", files.skeleton, ".skeleton")->required();
  command->add_option("--skin", files.skin, ".skin, of the mesh's vertices")->required();
  command->add_option("--mesh", files.mesh, ".obj, mm, at the skeleton's zero angles (.ply, .glb)")->required();
  command->add_option("--texture", files.texture, "picture of an .obj, instead of its material's map_Kd");
  command->add_option("--labels", files.labels,
                      "material of each vertex (LIP ids): .npy, or text with one a line; else guessed");
  command->add_option("--bones", files.bones,
                      "bones.json: {\"left_wrist\": \"name of a bone\"}, for a skeleton with other names");
  CLI::Option* moved = command->add_option("--motion", motion.motion, ".motion of the skeleton, for --truth");
  command->add_option("--truth", options->truth, "folder to write the motion to, as `eval --truth` reads it");
  CLI::Option* cameras =
      command->add_option("--cameras", motion.cameras, ".calibration; else the motion is in the camera's frame")
          ->needs(moved);
  command->add_option("--camera", motion.camera, "which of --cameras took the video")->needs(cameras);
  command
      ->add_option("--first", motion.first, "frame number of the motion that is the video's first; else its own first")
      ->needs(moved)
      ->check(at_least(0));
  command->add_option("--out", options->out, "actor.glb to write")->required();
  command->callback([options, &action] { action = [options] { return import_actor(*options); }; });
}

}  // namespace livecap::tools
