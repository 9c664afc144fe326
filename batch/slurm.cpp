#include "batch/slurm.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "geometry/error.h"

namespace fascia::batch {

std::string shell_word(const std::string& text) {
  std::string word = "'";
  for (const char c : text)
    word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

std::string slurm_time(double most_seconds) {
  const int minutes = static_cast<int>(std::ceil(std::clamp(most_seconds / 60.0, 10.0, 240.0)));
  char text[32];
  std::snprintf(text, sizeof text, "%02d:%02d:00", minutes / 60, minutes % 60);
  return text;
}

std::string slurm_script(const SlurmJob& job) {
  if (job.output.string().find_first_of("\n%") != std::string::npos)
    throw Error("'" + job.output.string() +
                "': Slurm takes no line end and no '%' in the folder of its logs; give another with -o");
  const std::string last = std::to_string(job.tasks - 1);
  std::string text = "#!/bin/bash\n#SBATCH --job-name=fascia\n#SBATCH --array=0-" + last;
  if (job.most_at_once > 0) text += "%" + std::to_string(job.most_at_once);
  text += "\n#SBATCH --cpus-per-task=" + std::to_string(job.jobs) +
          "\n#SBATCH --mem=" + std::to_string(job.jobs * job.megabytes) + "M\n#SBATCH --time=" + job.time +
          "\n#SBATCH --requeue\n#SBATCH --open-mode=append\n";
  if (!job.partition.empty()) text += "#SBATCH --partition=" + job.partition + "\n";
  text += "#SBATCH --output=" + job.output.string() + "/.logs/%A_%a.txt\n\nexec " +
          shell_word(job.tool.string()) + " batch " + shell_word(job.source.string()) + " -o " +
          shell_word(job.output.string()) + " --task-count " + std::to_string(job.tasks) +
          " --task-index \"$SLURM_ARRAY_TASK_ID\" --jobs " + std::to_string(job.jobs) + " --memory " +
          std::to_string(job.megabytes);
  for (const std::string& option : job.options)
    text += " " + shell_word(option);
  return text + "\n";
}

}  // namespace fascia::batch
