// Runs a fuzz target without libFuzzer: the files of its corpus, and changes of them by chance. So every
// build compiles the targets and every suite runs what was found once.
//   replay FILE|FOLDER... [--runs N] [--seconds S] [--seed K] [--max-size BYTES]
// An input that ends the program, or computes for more than 20 seconds, is left as finding-K in the working
// folder.
#include <fcntl.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size);

namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<uint8_t>;

const Bytes* running = nullptr;
const char* finding = "finding";

void keep_and_end(int signal) {
  const int file = open(finding, O_CREAT | O_WRONLY | O_TRUNC, 0644);
  if (running != nullptr && file >= 0 && write(file, running->data(), running->size()) >= 0) {
    static const char said[] = "the input is left as ";
    if (write(2, said, sizeof said - 1) + write(2, finding, std::strlen(finding)) + write(2, "\n", 1) < 0)
      _exit(99);
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// Of computing, not of waiting for others: the machine may be busy.
void allow_seconds(long seconds) {
  itimerval timer = {};
  timer.it_value.tv_sec = seconds;
  setitimer(ITIMER_PROF, &timer, nullptr);
}

void run(const Bytes& input) {
  running = &input;
  allow_seconds(20);
  LLVMFuzzerTestOneInput(input.data(), input.size());
  allow_seconds(0);
  running = nullptr;
}

Bytes bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return Bytes(std::istreambuf_iterator<char>(file), {});
}

class Mutator {
 public:
  Mutator(std::vector<Bytes> corpus, uint32_t seed, size_t max_size)
      : corpus_(std::move(corpus)), random_(seed), max_size_(max_size) {
    corpus_.push_back({});
  }
  Bytes next() {
    Bytes made = corpus_[below(corpus_.size())];
    for (size_t change = 1 + below(8); change > 0; --change)
      change_once(made);
    made.resize(std::min(made.size(), max_size_));
    return made;
  }

 private:
  size_t below(size_t count) { return std::uniform_int_distribution<size_t>(0, count - 1)(random_); }
  void insert(Bytes& made, const Bytes& what) {
    made.insert(made.begin() + static_cast<std::ptrdiff_t>(below(made.size() + 1)), what.begin(), what.end());
  }
  Bytes piece(const Bytes& of) {
    if (of.empty()) return {};
    const size_t begin = below(of.size()), size = 1 + below(std::min<size_t>(of.size() - begin, 64));
    const auto first = of.begin() + static_cast<std::ptrdiff_t>(begin);
    return Bytes(first, first + static_cast<std::ptrdiff_t>(size));
  }
  /// Where a number of the text begins and ends; both its size when there is none after a random place.
  std::pair<size_t, size_t> number_in(const Bytes& made) {
    const auto is_digit = [&](size_t i) { return std::strchr("+-.0123456789eE", made[i]) && made[i] != 0; };
    size_t begin = below(made.size());
    while (begin < made.size() && !is_digit(begin))
      ++begin;
    size_t end = begin;
    while (end < made.size() && is_digit(end))
      ++end;
    return {begin, end};
  }
  void change_once(Bytes& made) {
    static const char* const numbers[] = {"0",          "-1",     "1e999", "-1e308", "4294967296",
                                          "2147483647", "1e-320", "nan",   "null",   "[]",
                                          "{}",         "\"\"",   "1.5",   "65536"};
    if (made.empty()) return insert(made, Bytes(1 + below(64), static_cast<uint8_t>(below(256))));
    switch (below(8)) {
      case 0:
        made[below(made.size())] ^= static_cast<uint8_t>(1U << below(8));
        break;
      case 1:
        made[below(made.size())] = static_cast<uint8_t>(below(256));
        break;
      case 2:
        made[below(made.size())] = std::vector<uint8_t>{0, 255, 127, 128, '"', '{', '\n', ','}[below(8)];
        break;
      case 3: {
        Bytes random(1 + below(16));
        for (uint8_t& byte : random)
          byte = static_cast<uint8_t>(below(256));
        insert(made, random);
        break;
      }
      case 4: {
        const size_t begin = below(made.size());
        const size_t size = 1 + below(std::min<size_t>(made.size() - begin, 64));
        const auto first = made.begin() + static_cast<std::ptrdiff_t>(begin);
        made.erase(first, first + static_cast<std::ptrdiff_t>(size));
        break;
      }
      case 5:
        insert(made, piece(made));
        break;
      case 6:
        insert(made, piece(corpus_[below(corpus_.size())]));
        break;
      default: {
        const auto [begin, end] = number_in(made);
        const std::string text = numbers[below(std::size(numbers))];
        made.erase(made.begin() + static_cast<std::ptrdiff_t>(begin),
                   made.begin() + static_cast<std::ptrdiff_t>(end));
        made.insert(made.begin() + static_cast<std::ptrdiff_t>(begin), text.begin(), text.end());
      }
    }
  }

  std::vector<Bytes> corpus_;
  std::mt19937 random_;
  size_t max_size_;
};

}  // namespace

int main(int argc, char** argv) {
  std::vector<fs::path> files;
  long runs = 0, seconds = 0, seed = 1, max_size = 16384;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    long* const number = word == "--runs"       ? &runs
                         : word == "--seconds"  ? &seconds
                         : word == "--seed"     ? &seed
                         : word == "--max-size" ? &max_size
                                                : nullptr;
    if (number != nullptr && i + 1 < argc)
      *number = std::atol(argv[++i]);
    else if (fs::is_directory(word))
      for (const auto& entry : fs::directory_iterator(word))
        files.push_back(entry.path());
    else
      files.push_back(word);
  }
  std::sort(files.begin(), files.end());
  const std::string name = "finding-" + std::to_string(seed);
  finding = name.c_str();
  for (const int signal : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGTRAP, SIGPROF})
    std::signal(signal, keep_and_end);

  std::vector<Bytes> corpus;
  for (const fs::path& file : files) {
    if (!fs::exists(file)) {
      std::fprintf(stderr, "%s: there is no such file\n", file.c_str());
      return 2;
    }
    corpus.push_back(bytes_of(file));
    run(corpus.back());
  }
  if (corpus.empty()) return 2;
  Mutator mutator(corpus, static_cast<uint32_t>(seed), static_cast<size_t>(max_size));
  const auto begun = std::chrono::steady_clock::now();
  const auto passed = [&] { return std::chrono::steady_clock::now() - begun; };
  long done = 0;
  for (; done < runs || passed() < std::chrono::seconds(seconds); ++done)
    run(mutator.next());
  std::printf("%zu files and %ld changes of them\n", files.size(), done);
  return 0;
}
