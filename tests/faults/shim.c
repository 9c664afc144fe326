/* Preloaded before the tool: makes one call of one kind fail, to see that nothing is lost when it does.
 *   FASCIA_FAULT=KIND:N   the N-th call of KIND fails, counted from 1; N = 0 counts only
 *   FASCIA_CLOCK_JUMP=N   the time of day goes N seconds back and forth from call to call
 *   FASCIA_FAULT_LOG=FILE gets the number of calls of every kind when the process ends, "KIND N" a line
 * Kinds: malloc (malloc, calloc, realloc, posix_memalign, aligned_alloc), read, open, write, rename,
 * renameat2, fsync, close, mkdir, linkat, fchmod, unlink. Reading counts for files under the folder
 * FASCIA_FAULT_FOLDER only; opening, writing and closing for those of them that are written.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

enum kind {
  MALLOC,
  READ,
  OPEN_,
  WRITE,
  RENAME,
  RENAMEAT2,
  FSYNC,
  CLOSE,
  MKDIR,
  LINKAT,
  FCHMOD,
  UNLINK,
  KINDS
};
static const char* const kind_names[KINDS] = {"malloc", "read",  "open",  "write",  "rename", "renameat2",
                                              "fsync",  "close", "mkdir", "linkat", "fchmod", "unlink"};
static char log_file[512], folder[512];
static int wanted_kind = -1;
static long wanted, clock_jump;
static atomic_long calls[KINDS];
static int is_ready;

__attribute__((constructor)) static void begin(void) {
  const char* fault = getenv("FASCIA_FAULT");
  const char* log = getenv("FASCIA_FAULT_LOG");
  const char* place = getenv("FASCIA_FAULT_FOLDER");
  const char* jump = getenv("FASCIA_CLOCK_JUMP");
  if (jump) clock_jump = atol(jump);
  char kind[16] = "";
  if (fault) sscanf(fault, "%15[a-z0-9]:%ld", kind, &wanted);
  for (int k = 0; k < KINDS; ++k)
    if (strcmp(kind, kind_names[k]) == 0) wanted_kind = k;
  if (log) snprintf(log_file, sizeof log_file, "%s", log);
  if (place) snprintf(folder, sizeof folder, "%s", place);
  unsetenv("LD_PRELOAD"); /* what the tool starts is not its own fault */
  is_ready = 1;
}

/* True when this call has to fail. */
static int fails(enum kind kind) {
  return is_ready && atomic_fetch_add(&calls[kind], 1) + 1 == wanted && (int)kind == wanted_kind;
}

__attribute__((destructor)) static void end(void) {
  is_ready = 0;
  if (log_file[0] == 0) return;
  FILE* file = fopen(log_file, "w");
  if (!file) return;
  for (int k = 0; k < KINDS; ++k)
    fprintf(file, "%s %ld\n", kind_names[k], (long)calls[k]);
  fclose(file);
}

#define REAL(name)               \
  static __typeof__(&name) real; \
  if (!real) real = (__typeof__(&name))dlsym(RTLD_NEXT, #name)

/* Before dlsym has answered: it may allocate itself. */
extern void* __libc_malloc(size_t);
extern void* __libc_calloc(size_t, size_t);
extern void* __libc_realloc(void*, size_t);
extern void* __libc_memalign(size_t, size_t);

void* malloc(size_t size) {
  if (fails(MALLOC)) {
    errno = ENOMEM;
    return NULL;
  }
  return __libc_malloc(size);
}
void* calloc(size_t count, size_t size) {
  if (fails(MALLOC)) {
    errno = ENOMEM;
    return NULL;
  }
  return __libc_calloc(count, size);
}
void* realloc(void* old, size_t size) {
  if (fails(MALLOC)) {
    errno = ENOMEM;
    return NULL;
  }
  return __libc_realloc(old, size);
}
int posix_memalign(void** to, size_t alignment, size_t size) {
  if (fails(MALLOC)) return ENOMEM;
  *to = __libc_memalign(alignment, size);
  return *to ? 0 : ENOMEM;
}
void* aligned_alloc(size_t alignment, size_t size) {
  if (fails(MALLOC)) {
    errno = ENOMEM;
    return NULL;
  }
  return __libc_memalign(alignment, size);
}

/* Files of the test's folder that are open, for writing and for reading. */
static char is_watched[1024], is_read[1024];

static int is_inside(const char* path) {
  return folder[0] && strncmp(path, folder, strlen(folder)) == 0;
}

static int is_ours(const char* path, int flags) {
  return (flags & O_ACCMODE) != O_RDONLY && is_inside(path);
}

static int opened(int file, const char* path, int flags) {
  if (file < 0 || file >= (int)sizeof is_watched) return file;
  is_watched[file] = (char)is_ours(path, flags);
  is_read[file] = (char)((flags & O_ACCMODE) == O_RDONLY && is_inside(path));
  return file;
}

#define OPEN(name)                                                          \
  int name(const char* path, int flags, ...) {                              \
    REAL(name);                                                             \
    va_list list;                                                           \
    va_start(list, flags);                                                  \
    const int mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(list, int) : 0; \
    va_end(list);                                                           \
    if (is_ours(path, flags) && fails(OPEN_)) {                             \
      errno = EROFS;                                                        \
      return -1;                                                            \
    }                                                                       \
    return opened(real(path, flags, mode), path, flags);                    \
  }
OPEN(open)
OPEN(open64)

#define FOPEN(name)                                                            \
  FILE* name(const char* path, const char* how) {                              \
    REAL(name);                                                                \
    if (is_ours(path, how[0] == 'r' ? O_RDONLY : O_WRONLY) && fails(OPEN_)) {  \
      errno = EROFS;                                                           \
      return NULL;                                                             \
    }                                                                          \
    FILE* file = real(path, how);                                              \
    if (file) opened(fileno(file), path, how[0] == 'r' ? O_RDONLY : O_WRONLY); \
    return file;                                                               \
  }
FOPEN(fopen)
FOPEN(fopen64)

static int is_of_ours(int file) {
  return file >= 0 && file < (int)sizeof is_watched && is_watched[file];
}

ssize_t read(int file, void* bytes, size_t size) {
  REAL(read);
  if (file >= 0 && file < (int)sizeof is_read && is_read[file] && fails(READ)) {
    errno = EIO;
    return -1;
  }
  return real(file, bytes, size);
}
ssize_t write(int file, const void* bytes, size_t size) {
  REAL(write);
  if (is_of_ours(file) && fails(WRITE)) {
    if (size > 1) real(file, bytes, size / 2); /* half of it came through */
    errno = ENOSPC;
    return -1;
  }
  return real(file, bytes, size);
}
ssize_t writev(int file, const struct iovec* parts, int count) {
  REAL(writev);
  if (is_of_ours(file) && fails(WRITE)) {
    errno = ENOSPC;
    return -1;
  }
  return real(file, parts, count);
}
int fsync(int file) {
  REAL(fsync);
  if (fails(FSYNC)) {
    errno = EIO;
    return -1;
  }
  return real(file);
}
int close(int file) {
  REAL(close);
  const int watched = is_of_ours(file);
  if (file >= 0 && file < (int)sizeof is_watched) is_watched[file] = is_read[file] = 0;
  if (watched && fails(CLOSE)) {
    real(file);
    errno = EIO;
    return -1;
  }
  return real(file);
}
int rename(const char* from, const char* to) {
  REAL(rename);
  if (fails(RENAME)) {
    errno = EIO;
    return -1;
  }
  return real(from, to);
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  REAL(renameat2);
  if (fails(RENAMEAT2)) {
    errno = EIO;
    return -1;
  }
  return real(from_folder, from, to_folder, to, flags);
}
int mkdir(const char* path, mode_t mode) {
  REAL(mkdir);
  if (is_inside(path) && fails(MKDIR)) {
    errno = ENOSPC;
    return -1;
  }
  return real(path, mode);
}
int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) {
  REAL(linkat);
  if (fails(LINKAT)) {
    errno = EIO;
    return -1;
  }
  return real(from_folder, from, to_folder, to, flags);
}
int fchmod(int file, mode_t mode) {
  REAL(fchmod);
  if (fails(FCHMOD)) {
    errno = EIO;
    return -1;
  }
  return real(file, mode);
}
int unlink(const char* path) {
  REAL(unlink);
  if (is_inside(path) && fails(UNLINK)) {
    errno = EIO;
    return -1;
  }
  return real(path);
}

/* Seconds by which the time of day is wrong at this call. */
static long off_by(void) {
  static atomic_long looks;
  return atomic_fetch_add(&looks, 1) % 2 ? clock_jump : -clock_jump;
}
int clock_gettime(clockid_t clock, struct timespec* now) {
  REAL(clock_gettime);
  const int result = real(clock, now);
  if (result == 0 && clock == CLOCK_REALTIME) now->tv_sec += off_by();
  return result;
}
time_t time(time_t* to) {
  REAL(time);
  const time_t now = real(NULL) + off_by();
  if (to) *to = now;
  return now;
}
