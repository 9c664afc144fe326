// Overflows: with the sanitizer of undefined behaviour it has to end with an error.
#include <cstdio>
#include <limits>

int main(int count, char**) {
  const int most = std::numeric_limits<int>::max();
  std::printf("%d\n", most + count);
  return 0;
}
