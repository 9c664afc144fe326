// Which heads a manifest or folder names, and which task has which.
#include <gtest/gtest.h>

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <set>

#include "batch/manifest.h"
#include "batch/places.h"
#include "batch/record.h"
#include "batch/slurm.h"
#include "geometry/error.h"

namespace fascia::batch {
namespace {

namespace fs = std::filesystem;

class Manifest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() / ("fascia_manifest_" + std::to_string(getpid()));
    fs::remove_all(folder);
    fs::create_directories(folder / "sub");
  }
  void TearDown() override { fs::remove_all(folder); }
  fs::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder / name, std::ios::binary) << text;
    return folder / name;
  }
  void expect_refused(const std::string& text, const std::string& says) {
    try {
      read_heads(write("wrong.jsonl", text));
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  }
  fs::path folder;
};

TEST_F(Manifest, FoldersGiveEveryMeshAnIdOfItsOwn) {
  for (const char* name : {"a.obj", "a.glb", "sub/a.obj", "sub a.PLY", "notes.txt", ".hidden.stl"})
    write(name, "x");
  const std::vector<Head> heads = read_heads(folder);
  std::set<std::string> ids;
  for (const Head& head : heads) {
    ids.insert(head.id);
    EXPECT_NE(head.id[0], '.');
    EXPECT_EQ(head.id.find('/'), std::string::npos);
  }
  EXPECT_EQ(ids, (std::set<std::string>{"a", "a.obj", "sub_a", "sub_a.PLY", "_.hidden"}));
  EXPECT_EQ(heads.size(), 5U);
  // The same ids every time.
  const std::vector<Head> again = read_heads(folder);
  for (size_t i = 0; i < heads.size(); ++i)
    EXPECT_EQ(heads[i].id, again[i].id);
}

TEST_F(Manifest, LinesSayHeadsAndOptions) {
  const fs::path file =
      write("heads.jsonl",
            "{\"head\": \"a.obj\", \"id\": \"anna\", \"units\": \"mm\", \"tissue_scale\": 1.1}\r\n\n"
            "{\"head\": \"/far/b.glb\", \"landmarks\": \"b.json\", \"edits\": \"e.json\"}");
  const std::vector<Head> heads = read_heads(file);
  ASSERT_EQ(heads.size(), 2U);
  EXPECT_EQ(heads[0].id, "anna");
  EXPECT_EQ(heads[0].file, folder / "a.obj");
  EXPECT_EQ(heads[0].options, (std::vector<std::string>{"--tissue-scale", "1.1", "--units", "mm"}));
  EXPECT_EQ(heads[1].file, fs::path("/far/b.glb"));
  EXPECT_EQ(heads[1].landmarks, folder / "b.json");
}

TEST_F(Manifest, SaysWhichLineIsWrong) {
  expect_refused("", "names no head");
  expect_refused("{\"head\": \"a\"}\nhead.obj\n", "line 2");
  expect_refused("{\"id\": \"a\"}", "names no \"head\"");
  expect_refused("{\"head\": \"a\", \"haed\": 1}", "haed");
  expect_refused("{\"head\": \"a\", \"id\": \"../up\"}", "becomes a folder");
  expect_refused("{\"head\": \"a\", \"id\": \".work\"}", "becomes a folder");
  expect_refused("{\"head\": \"a\", \"id\": \"x\"}\n{\"head\": \"b\", \"id\": \"x\"}", "line 1");
  expect_refused("{\"head\": [1]}", "neither text nor a number");
  expect_refused(std::string(10000, '['), "line 1: it is nested more than 4 deep");
  EXPECT_THROW(read_heads(folder / "sub"), Error);
  EXPECT_THROW(read_heads(folder / "missing"), Error);
}

TEST_F(Manifest, TasksShareEveryHeadOnce) {
  std::vector<Head> heads(17);
  for (size_t i = 0; i < heads.size(); ++i)
    heads[i].id = std::to_string(i);
  for (const size_t count : {1, 2, 5, 17, 30}) {
    std::multiset<std::string> ids;
    for (size_t index = 0; index < count; ++index)
      for (const Head& head : share(heads, index, count))
        ids.insert(head.id);
    EXPECT_EQ(ids.size(), 17U);
    EXPECT_EQ(std::set<std::string>(ids.begin(), ids.end()).size(), 17U);
  }
}

TEST_F(Manifest, FoldersOfResultsHoldNoHeads) {
  write("a.obj", "x");
  for (const char* made : {"out/a", "out/.work/b", "out/.locks"})
    fs::create_directories(folder / made);
  write("out/a/rig.glb", "x");
  write("out/.work/b/rig.glb", "x");
  EXPECT_EQ(read_heads(folder).size(), 2U) << "a rig without a record is a file like any other";
  write_record(folder / "out" / "a", {});
  EXPECT_EQ(read_heads(folder).size(), 1U);
}

TEST_F(Manifest, NoInputLiesWhereResultsGo) {
  fs::create_directories(folder / "scans" / "anna");
  const fs::path scan = write("scans/anna/head.obj", "x"), beside = write("scans/landmarks.json", "{}");
  const auto expect_refused_into = [&](const fs::path& output, const Head& head) {
    try {
      check_inputs({head, {"bert", beside, "", "", {}}}, output);
      ADD_FAILURE() << output;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("-o"), std::string::npos) << error.what();
    }
  };
  expect_refused_into(folder / "scans", {"anna", scan, "", "", {}});
  expect_refused_into(folder / "scans" / ".." / "scans", {"anna", beside, scan, "", {}});
  expect_refused_into(folder, {"scans", beside, "", scan, {}});
  fs::create_directory_symlink(folder / "scans", folder / "link");
  expect_refused_into(folder / "link", {"anna", scan, "", "", {}});
  fs::create_symlink(scan, folder / "linked.obj");
  expect_refused_into(folder / "scans", {"anna", folder / "linked.obj", "", "", {}});
  expect_refused_into(folder / "scans", {"bert", scan, folder / "scans" / ".work" / "x.json", "", {}});
  EXPECT_NO_THROW(check_inputs({{"bert", scan, beside, "", {}}}, folder / "scans"));
  EXPECT_NO_THROW(check_inputs({{"anna", scan, "", "", {}}}, folder / "out"));
}

class Environment : public ::testing::Test {
 protected:
  void SetUp() override { TearDown(); }
  void TearDown() override {
    for (const char* name : {"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_STEP",
                             "SLURM_ARRAY_TASK_COUNT", "SLURM_PROCID", "SLURM_NTASKS",
                             "AWS_BATCH_JOB_ARRAY_INDEX", "AWS_BATCH_JOB_ARRAY_SIZE", "PARALLEL_SEQ"})
      unsetenv(name);
  }
  static void expect_task(size_t given, size_t index, size_t count) {
    const Task task = task_of_environment(given);
    EXPECT_EQ(task.index, index);
    EXPECT_EQ(task.count, count);
  }
};

TEST_F(Environment, WithoutVariablesOneTaskHasAllHeads) {
  expect_task(0, 0, 1);
  EXPECT_THROW(task_of_environment(4), Error);
}

TEST_F(Environment, KnowsSlurmAwsAndParallel) {
  setenv("PARALLEL_SEQ", "3", 1);
  expect_task(4, 2, 4);
  setenv("SLURM_PROCID", "5", 1);
  setenv("SLURM_NTASKS", "8", 1);
  expect_task(0, 5, 8);
  setenv("AWS_BATCH_JOB_ARRAY_INDEX", "7", 1);
  setenv("AWS_BATCH_JOB_ARRAY_SIZE", "10", 1);
  expect_task(0, 7, 10);
  setenv("SLURM_ARRAY_TASK_ID", "14", 1);
  setenv("SLURM_ARRAY_TASK_MIN", "10", 1);
  setenv("SLURM_ARRAY_TASK_STEP", "2", 1);
  setenv("SLURM_ARRAY_TASK_COUNT", "5", 1);
  expect_task(0, 2, 5);
  expect_task(20, 14, 20);
}

TEST_F(Environment, RejectsInvalidVariables) {
  setenv("SLURM_ARRAY_TASK_ID", "two", 1);
  EXPECT_THROW(task_of_environment(0), Error);
  setenv("SLURM_ARRAY_TASK_ID", "9", 1);
  setenv("SLURM_ARRAY_TASK_COUNT", "4", 1);
  EXPECT_THROW(task_of_environment(0), Error);
}

TEST_F(Manifest, KeysFollowEveryFileAndOption) {
  Head head;
  head.file = write("a.obj", "v 0 0 0");
  head.landmarks = write("l.json", "{}");
  const std::string first = key_of(head, "1");
  EXPECT_EQ(key_of(head, "1"), first);
  EXPECT_NE(key_of(head, "2"), first);
  head.options = {"--units", "mm"};
  EXPECT_NE(key_of(head, "1"), first);
  head.options.clear();
  write("l.json", "{ }");
  EXPECT_NE(key_of(head, "1"), first);
  write("l.json", "{}");
  EXPECT_EQ(key_of(head, "1"), first);

  Head gltf;
  gltf.file = write("b.gltf", R"({"buffers": [{"uri": "b.bin"}]})");
  const std::string missing = key_of(gltf, "1");
  write("b.bin", "1234");
  EXPECT_NE(key_of(gltf, "1"), missing);
  gltf.file = folder / "none.obj";
  EXPECT_THROW(key_of(gltf, "1"), Error);
}

TEST_F(Manifest, KeysFollowPicturesAndMaterials) {
  Head gltf;
  gltf.file = write("c.gltf", R"({"buffers": [{"uri": "my%20numbers.bin"}], "images": [{"uri": "skin.png"}],
                                  "extras": {"uri": "other.png"}})");
  Head obj;
  obj.file = write("c.obj", "mtllib my materials.mtl \r\nv 0 0 0\n");
  write("my materials.mtl", "newmtl skin\n  map_Kd -s 1 1 1 my skin.jpg\n");
  std::set<std::string> keys;
  for (const char* name : {"", "my numbers.bin", "skin.png"}) {
    if (*name) write(name, "1");
    EXPECT_TRUE(keys.insert(key_of(gltf, "1")).second) << name;
  }
  write("other.png", "1");
  EXPECT_FALSE(keys.insert(key_of(gltf, "1")).second) << "nothing reads it";
  for (const char* name : {"", "my skin.jpg", "my materials.mtl"}) {
    if (*name) write(name, "newmtl skin\nmap_Kd my skin.jpg\n");
    EXPECT_TRUE(keys.insert(key_of(obj, "1")).second) << name;
  }
}

TEST_F(Manifest, KeysOpenNothingOutsideAHeadsFolder) {
  fs::create_directories(folder / "heads");
  ASSERT_EQ(mkfifo((folder / "heads" / "pipe.bin").c_str(), 0600), 0);
  Head head;
  for (const std::string& uri :
       {std::string("/dev/zero"), std::string("../outside.bin"), std::string("pipe.bin"),
        (folder / "outside.bin").string(), std::string("%2e%2e/outside.bin")}) {
    head.file = write("heads/a.gltf", R"({"buffers": [{"uri": ")" + uri + "\"}]}");
    fs::remove(folder / "outside.bin");
    const std::string key = key_of(head, "1");
    write("outside.bin", "1");
    EXPECT_EQ(key_of(head, "1"), key) << uri;
  }
  head.file = folder / "heads" / "pipe.bin";
  EXPECT_THROW(key_of(head, "1"), Error);
}

TEST(Slurm, QuotesWhatAShellWouldTakeApart) {
  EXPECT_EQ(shell_word("it's $HOME"), "'it'\\''s $HOME'");
  SlurmJob job;
  job.tool = "/opt/fascia";
  job.source = "/heads of all";
  job.output = "/out";
  job.tasks = 7;
  job.most_at_once = 3;
  job.jobs = 2;
  job.megabytes = 1000;
  EXPECT_EQ(slurm_time(1.0), "00:10:00");
  EXPECT_EQ(slurm_time(2400.5), "00:41:00");
  EXPECT_EQ(slurm_time(1e9), "04:00:00");
  const std::string script = slurm_script(job);
  EXPECT_NE(script.find("#SBATCH --array=0-6%3\n"), std::string::npos) << script;
  EXPECT_NE(script.find("#SBATCH --mem=2000M\n"), std::string::npos);
  EXPECT_NE(script.find("'/opt/fascia' batch '/heads of all' -o '/out' --task-count 7"), std::string::npos);
  job.output = "/a%b";
  EXPECT_THROW(slurm_script(job), Error);
}

}  // namespace
}  // namespace fascia::batch
