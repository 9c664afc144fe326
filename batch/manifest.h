#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// Batch processing: heads to build, their distribution over tasks, and their results.
namespace fascia::batch {

/// One head to build.
struct Head {
  std::string id;                    ///< its folder's name in the output: letters, digits, '.', '_' and '-'
  std::filesystem::path file;        ///< the mesh
  std::filesystem::path landmarks;   ///< or empty
  std::filesystem::path edits;       ///< or empty
  std::vector<std::string> options;  ///< more options of `fascia build`
};

/// The heads of a folder (every .glb, .gltf, .obj, .ply and .stl in it and below, by path, but for what
/// batches made) or of a manifest:
/// one JSON object a line, {"head": FILE, "id": NAME, "landmarks": FILE, "edits": FILE, "units": ..., "up":
/// ..., "skin": ..., "tissue_scale": ..., "detail": ..., "open": ..., "add": ...}, of which only "head" is
/// needed; files from the manifest's folder. Throws fascia::Error naming the line and what is wrong with it,
/// and when there is no head at all.
std::vector<Head> read_heads(const std::filesystem::path& source);

/// Those of task `index` of `count`: every count-th, so that each head is in exactly one task.
std::vector<Head> share(const std::vector<Head>& heads, size_t index, size_t count);

/// Index of this task, and number of tasks.
struct Task {
  size_t index = 0, count = 1;
};

/// The task that a cluster's variables name: Slurm's array (SLURM_ARRAY_TASK_ID, _MIN, _STEP, _COUNT) or else
/// its parallel tasks (SLURM_PROCID, SLURM_NTASKS), AWS Batch's array (AWS_BATCH_JOB_ARRAY_INDEX, _SIZE), GNU
/// parallel's (PARALLEL_SEQ, counted from 1, where `count` is given). All of it when there are none. `count`
/// above 0 is the number of tasks the user gave. Throws fascia::Error for variables that make no sense.
Task task_of_environment(size_t count);

/// What the results of a head depend on, as a hash: the bytes of its file and of those that it names (in its
/// folder, or anywhere with the option --allow-outside), its options and `version`, the tool's. Throws
/// fascia::Error when a file cannot be read.
std::string key_of(const Head& head, const std::string& version);

}  // namespace fascia::batch
