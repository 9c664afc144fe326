#include "formats/files.h"
#include "formats/file_lock.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <thread>

#include "formats/file_lock.h"
#include "formats/new_file.h"
#include "formats/obj_lines.h"
#include "formats/partial.h"
#include "formats/scene.h"
#include "geometry/error.h"

namespace fascia::formats {
namespace {

namespace fs = std::filesystem;

class Files : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "fascia_files_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    fs::create_directories(folder_ / "in" / "tex");
    write_text(folder_ / "secret.txt", "secret");
    write_text(folder_ / "in" / "tex" / "skin \xC3\xA4.png", "skin");
  }
  void TearDown() override { fs::remove_all(folder_); }

  size_t count() const {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

TEST_F(Files, OpensWhatLiesBesideAndBelow) {
  const fs::path owner = folder_ / "in" / "head.gltf";
  for (const char* name :
       {"tex/skin \xC3\xA4.png", "tex\\skin \xC3\xA4.png", "./tex/../tex/skin \xC3\xA4.png"})
    EXPECT_TRUE(read_beside(owner, name, Outside::refused).bytes) << name;
  EXPECT_NE(read_beside(owner, "tex/gone.png", Outside::refused).why.find("is not there"), std::string::npos);
}

TEST_F(Files, OpensNothingOutsideUnlessTold) {
  const fs::path owner = folder_ / "in" / "head.gltf";
  fs::create_symlink(folder_ / "secret.txt", folder_ / "in" / "link.png");
  fs::create_directories(folder_ / "inside");  // its name begins like the folder's
  write_text(folder_ / "inside" / "x.png", "x");
  for (const std::string& name :
       {std::string("../secret.txt"), (folder_ / "secret.txt").string(), std::string("tex/../../secret.txt"),
        std::string("..\\secret.txt"), std::string("link.png"), std::string("../inside/x.png")}) {
    const FileBeside refused = read_beside(owner, name, Outside::refused_by_default);
    EXPECT_FALSE(refused.bytes) << name;
    EXPECT_NE(refused.why.find("--allow-outside"), std::string::npos) << name;
    const FileBeside without_option = read_beside(owner, name, Outside::refused);
    EXPECT_FALSE(without_option.bytes) << name;
    EXPECT_EQ(without_option.why.find("--"), std::string::npos) << without_option.why;
    EXPECT_TRUE(read_beside(owner, name, Outside::allowed).bytes) << name;
  }
}

TEST_F(Files, AGltfBringsNothingInFromOutside) {
  const std::string head =
      R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"images":[{"uri":"%2e%2e/secret.txt"}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":36}],
    "buffers":[{"byteLength":36,"uri":")";
  write_text(
      folder_ / "in" / "head.gltf",
      head + "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}]}");
  const Scene scene = read(folder_ / "in" / "head.gltf");
  EXPECT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(std::string(scene.document.bin.begin(), scene.document.bin.end()).find("secret"),
            std::string::npos);
  write_text(folder_ / "in" / "worse.gltf", head + "../secret.txt\"}]}");
  EXPECT_THROW(read(folder_ / "in" / "worse.gltf"), Error);
}

TEST_F(Files, WritesKeepLinksAndPermissions) {
  const fs::path file = folder_ / "a.txt", link = folder_ / "link.txt";
  write_text(file, "old");
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink(file, link);
  write_text(link, "new");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(read_bytes(file), (std::vector<uint8_t>{'n', 'e', 'w'}));
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_NO_THROW(write_text("/dev/null", "gone"));
}

TEST_F(Files, ALinkToNothingGetsItsFile) {
  fs::create_directories(folder_ / "elsewhere");
  fs::create_symlink("elsewhere/new.txt", folder_ / "first.txt");
  fs::create_symlink(folder_ / "first.txt", folder_ / "second.txt");
  write_text(folder_ / "second.txt", "1234");
  EXPECT_TRUE(fs::is_symlink(folder_ / "second.txt"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "first.txt"));
  EXPECT_EQ(fs::file_size(folder_ / "elsewhere" / "new.txt"), 4u);
}

TEST_F(Files, WhatIsTooLargeIsRefused) {
  write_text(folder_ / "sparse.obj", "v 0 0 0");
  fs::resize_file(folder_ / "sparse.obj", most_bytes + 1);
  EXPECT_THROW(read_bytes(folder_ / "sparse.obj"), Error);
  if (fs::exists("/dev/zero")) {
    EXPECT_THROW(read_bytes("/dev/zero"), Error);
  }
}

TEST_F(Files, AFailedWriteLeavesWhatWasThere) {
  EXPECT_THROW(write_text(folder_ / "not" / "there.txt", "x"), Error);
  EXPECT_FALSE(fs::exists(folder_ / "not"));
  write_text(folder_ / "a.txt", "old");
  const size_t before = count();
  // A limit on the size of files is a full disk that every machine has.
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const struct rlimit limit = {1000, 1000};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      write_text(folder_ / "a.txt", std::string(5000, 'x'));
      _exit(1);
    } catch (const Error&) {
      _exit(0);
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(read_bytes(folder_ / "a.txt").size(), 3u);
  EXPECT_EQ(count(), before);
}

TEST_F(Files, TwoWritersDoNotMix) {
  const auto write_many = [&](char c) {
    for (int i = 0; i < 50; ++i)
      write_text(folder_ / "a.txt", std::string(100000, c));
  };
  std::thread other(write_many, 'b');
  write_many('a');
  other.join();
  const std::vector<uint8_t> bytes = read_bytes(folder_ / "a.txt");
  ASSERT_EQ(bytes.size(), 100000u);
  for (const uint8_t byte : bytes)
    ASSERT_EQ(byte, bytes[0]);
  EXPECT_EQ(count(), 3u);
}

TEST_F(Files, ASignalLeavesNothingHalfWritten) {
  for (int delay = 0; delay < 10; ++delay) {
    const pid_t child = fork();
    if (child == 0) {
      std::signal(SIGTERM, [](int) {
        remove_partial_files();
        _exit(0);
      });
      const std::string text(1 << 20, 'x');
      for (;;)
        write_text(folder_ / "a.txt", text);
    }
    usleep(static_cast<useconds_t>(20000 + 3000 * delay));
    kill(child, SIGTERM);
    int status = 0;
    waitpid(child, &status, 0);
    if (fs::exists(folder_ / "a.txt")) {
      EXPECT_EQ(fs::file_size(folder_ / "a.txt"), 1u << 20);
    }
    for (const auto& entry : fs::directory_iterator(folder_))
      EXPECT_NE(entry.path().extension(), ".part") << entry.path();
  }
}

TEST_F(Files, NothingIsMadeAfterTheLastSweep) {
  for (int k = 0; k < 5; ++k) {
    const pid_t child = fork();
    if (child == 0) {
      const auto write_on = [&] {
        for (;;)
          NewFile(folder_ / "a.txt");
      };
      std::thread(write_on).detach();
      std::thread(write_on).detach();
      usleep(10000);
      remove_partial_files();
      usleep(10000);  // threads go on until a process has ended
      _exit(0);
    }
    waitpid(child, nullptr, 0);
    for (const auto& entry : fs::directory_iterator(folder_))
      EXPECT_NE(entry.path().extension(), ".part") << entry.path();
  }
}

TEST_F(Files, ANamelessFileIsSeenWhenItIsInPlace) {
  const size_t before = count();
  NewFile file = NewFile::nameless(folder_ / "film.bin");
  // Where the file system has no such thing, it has a name of its own at once.
  const bool has_name = count() > before;
  EXPECT_TRUE(fs::exists(file.opened()));
  file.write(std::vector<uint8_t>(100));
  EXPECT_FALSE(fs::exists(folder_ / "film.bin"));
  EXPECT_EQ(count(), before + (has_name ? 1 : 0));
  file.put_in_place();
  EXPECT_EQ(fs::file_size(folder_ / "film.bin"), 100u);
  EXPECT_EQ(count(), before + 1);
}

TEST_F(Files, WhatBelongsTogetherIsThereAsAWholeOrNotAtAll) {
  const fs::path shapes = folder_ / "shapes";
  const auto write = [&](PartialGroup& together, const fs::path& folder) {
    together.add(folder);
    fs::create_directory(folder);
    for (int i = 0; i < 100; ++i) {
      const fs::path file = folder / (std::to_string(i) + ".obj");
      together.add(file);
      write_text(file, "v 0 0 0");
    }
  };
  {
    PartialGroup together;
    write(together, shapes);
  }
  EXPECT_FALSE(fs::exists(shapes)) << "an error came between";
  const pid_t child = fork();
  if (child == 0) {
    PartialGroup together;
    write(together, shapes);
    remove_partial_files();
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  EXPECT_FALSE(fs::exists(shapes)) << "a signal came between";
  fs::create_directory(shapes);
  write_text(shapes / "7.obj", "old");
  {
    PartialGroup together;
    write(together, shapes);
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(shapes), {}), 1) << "what was there stays";
  {
    PartialGroup together;
    write(together, shapes);
    together.keep();
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(shapes), {}), 100);
}

TEST(ObjLines, PlacesOfCoordinatesAreTheirBytes) {
  const std::string text = "\xEF\xBB\xBFvn 9 9 9\r  v 1 2.5 -3e1 0.7 0.7 0.7\r\nv 4 \\\n5\t6\nvt 1 1";
  const std::vector<ObjVertex> vertices = obj_vertices(text);
  ASSERT_EQ(vertices.size(), 2u);
  std::string digits;
  for (const ObjVertex& vertex : vertices)
    for (const auto& [begin, end] : vertex.coordinates)
      digits += text.substr(begin, end - begin) + "|";
  EXPECT_EQ(digits, "1|2.5|-3e1|4|5|6|");
  EXPECT_EQ(vertices[0].line, 2u);
  EXPECT_EQ(vertices[1].line, 3u);
}

TEST(FileLock, OneHoldsItUntilItIsLetGo) {
  const auto file = std::filesystem::temp_directory_path() / "fascia_file_lock";
  {
    const FileLock first(file, FileLock::Wait::no);
    EXPECT_TRUE(first.holds());
    EXPECT_FALSE(FileLock(file, FileLock::Wait::no).holds());
  }
  FileLock second(file, FileLock::Wait::yes), none;
  EXPECT_TRUE(second.holds());
  none = std::move(second);
  EXPECT_TRUE(none.holds());
  EXPECT_FALSE(second.holds());
  EXPECT_FALSE(FileLock("/nonexistent/folder/lock", FileLock::Wait::no).holds());
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace fascia::formats
