/* From a stream of landmarks to muscles: capture RIG.glb STREAM.csv|STREAM.jsonl|- [-o CURVES.csv]
 * [--no-neutral]
 *
 * Prints milliseconds a frame and what is left between points and fitted face. */
#define _POSIX_C_SOURCE 199309L
#include <fascia/fit.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { most_points = 478 };

/* A frame of the stream: 68 points of iBUG or 478 of MediaPipe, NAN where one was not seen. */
typedef struct {
  double seconds;
  int points;
  float xyz[3 * most_points];
} frame_of_points;

/* The whole of a file; NULL when it cannot be read. */
static unsigned char* read_file(const char* path, size_t* size) {
  FILE* file = fopen(path, "rb");
  unsigned char* bytes = NULL;
  long length;
  if (file == NULL) return NULL;
  if (fseek(file, 0, SEEK_END) == 0 && (length = ftell(file)) > 0 && fseek(file, 0, SEEK_SET) == 0) {
    bytes = malloc((size_t)length);
    *size = bytes == NULL ? 0 : fread(bytes, 1, (size_t)length, file);
    if (*size != (size_t)length) {
      free(bytes);
      bytes = NULL;
    }
  }
  fclose(file);
  return bytes;
}

static int fail(const char* what, const char* message) {
  fprintf(stderr, "capture: %s: %s\n", what, message);
  return 1;
}

/* The curves are written beside their place, PATH.part, and take it once they are whole: what was there
 * before stays when the stream breaks off. NULL when there is no memory. */
static char* part_of(const char* path) {
  char* part = malloc(strlen(path) + sizeof ".part");
  if (part != NULL) strcat(strcpy(part, path), ".part");
  return part;
}

/* Ends the file of curves: in its place when `status` is 0 and all of it is written, gone otherwise. */
static int put_in_place(FILE* file, const char* part, const char* path, int status) {
  const int is_whole = fflush(file) == 0 && ferror(file) == 0;
  const int is_closed = fclose(file) == 0;
  if (status == 0 && is_whole && is_closed) {
#ifdef _WIN32
    remove(path); /* where a rename replaces nothing */
#endif
    if (rename(part, path) == 0) return 0;
  }
  remove(part);
  return status != 0 ? status : fail(path, "cannot be written");
}

static double now_ms(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

static int is_known(int points) {
  return points == 68 || points == most_points;
}

/* Seconds, then x, y, z of every point with commas between, empty where it was not seen. 0 when it is not
 * that. */
static int parse_table_line(char* line, frame_of_points* to) {
  char *at, *end;
  int count = 0;
  to->seconds = strtod(line, &end);
  if (end == line) return 0;
  while (*end == ',' && count < 3 * most_points) {
    at = end + 1;
    to->xyz[count] = (float)strtod(at, &end);
    if (end == at) to->xyz[count] = NAN;
    ++count;
  }
  while (*end == '\r' || *end == '\n' || *end == ' ')
    ++end;
  to->points = count / 3;
  return *end == '\0' && count % 3 == 0 && is_known(to->points);
}

static char* past_space(char* at) {
  while (*at == ' ' || *at == '\t' || *at == '\r' || *at == '\n')
    ++at;
  return at;
}

/* Where the value of a member begins in a line of JSON whose names occur once; NULL without it. */
static char* member(char* line, const char* quoted_name) {
  char* at = strstr(line, quoted_name);
  if (at == NULL) return NULL;
  at = past_space(at + strlen(quoted_name));
  return *at == ':' ? past_space(at + 1) : NULL;
}

/* {"time": 0.033, "points": [[x, y, z], null, ...]}, as `fascia fit` takes the frames of a file; null is a
 * point that was not seen. 0 when it is not that. */
static int parse_json_line(char* line, frame_of_points* to) {
  char *at = member(line, "\"time\""), *end;
  int k;
  if (at == NULL) return 0;
  to->seconds = strtod(at, &end);
  if (end == at || (at = member(line, "\"points\"")) == NULL || *at != '[') return 0;
  at = past_space(at + 1);
  for (to->points = 0; *at != ']'; ++to->points) {
    float* point = to->xyz + 3 * to->points;
    if (to->points == most_points) return 0;
    if (strncmp(at, "null", 4) == 0) {
      point[0] = point[1] = point[2] = NAN;
      at = past_space(at + 4);
    } else {
      for (k = 0; k < 3; ++k) {
        if (*at != (k == 0 ? '[' : ',')) return 0;
        point[k] = (float)strtod(at + 1, &end);
        if (end == at + 1) return 0;
        at = past_space(end);
      }
      if (*at != ']') return 0;
      at = past_space(at + 1);
    }
    if (*at == ',') at = past_space(at + 1);
  }
  return is_known(to->points);
}

/* Plays the stream; what it is called in messages is `name`. */
static int play(FILE* stream, const char* name, fascia_asset* asset, const fascia_channels* channels,
                FILE* curves, int has_neutral) {
  static char line[1 << 17];
  static frame_of_points frame;
  fascia_fit_landmarks landmarks = {0};
  fascia_fit_result result = {0};
  fascia_fit* fit = NULL;
  double before, took, total = 0, slowest = 0, residual = 0;
  int number = 0, frames = 0, points = 0, status = 0;
  uint32_t c;
  result.struct_size = sizeof result;
  landmarks.struct_size = sizeof landmarks;
  while (status == 0 && fgets(line, sizeof line, stream) != NULL) {
    ++number;
    if (!(*past_space(line) == '{' ? parse_json_line(line, &frame) : parse_table_line(line, &frame))) {
      if (number == 1) continue; /* the heading */
      fprintf(stderr, "capture: %s, line %d: not a time and 68 or 478 points of x, y, z\n", name, number);
      status = 1;
      break;
    }
    if (fit == NULL) {
      points = frame.points;
      landmarks.set = points == 68 ? "ibug68" : "mediapipe478";
      if (fascia_fit_create(asset, &landmarks, NULL, &fit) != FASCIA_OK)
        status = fail(name, fascia_last_message());
      if (status == 0 && has_neutral && fascia_fit_set_neutral(fit, frame.xyz, NULL) != FASCIA_OK)
        status = fail("the first frame", fascia_last_message());
      if (status != 0) break;
    }
    if (frame.points != points) {
      fprintf(stderr, "capture: %s, line %d: %d points, %d before\n", name, number, frame.points, points);
      status = 1;
      break;
    }
    before = now_ms();
    if (fascia_fit_push(fit, frame.xyz, NULL, &result) != FASCIA_OK) {
      status = fail(name, fascia_last_message());
      break;
    }
    took = now_ms() - before;
    if (frames > 0) total += took; /* the first frame has the face to find */
    if (frames > 0 && took > slowest) slowest = took;
    residual += result.residual;
    ++frames;
    if (curves == NULL) continue;
    fprintf(curves, "%.6g", frame.seconds);
    for (c = 0; c < channels->count; ++c)
      fprintf(curves, ",%.5g", result.values[c]);
    fprintf(curves, "\n");
  }
  if (status == 0 && frames < 2) status = fail(name, "fewer than two frames");
  if (status == 0)
    printf("%d frames: %.2f ms a frame, slowest %.2f ms, %.3f mm left\n", frames, total / (frames - 1),
           slowest, 1e3 * residual / frames);
  fascia_fit_release(fit);
  return status;
}

int main(int argc, char** argv) {
  const char *rig = NULL, *stream_path = NULL, *curves_path = NULL;
  char* part = NULL;
  fascia_asset* asset = NULL;
  fascia_channels channels = {0};
  FILE *stream, *curves = NULL;
  unsigned char* bytes;
  size_t size = 0;
  int i, has_neutral = 1, status;
  uint32_t c;

  for (i = 1; i < argc; ++i) {
    if (strcmp(argv[i], "-o") == 0 && i + 1 < argc)
      curves_path = argv[++i];
    else if (strcmp(argv[i], "--no-neutral") == 0)
      has_neutral = 0;
    else if (rig == NULL)
      rig = argv[i];
    else
      stream_path = argv[i];
  }
  if (rig == NULL || stream_path == NULL) {
    fprintf(stderr, "usage: capture RIG.glb STREAM.csv|STREAM.jsonl|- [-o CURVES.csv] [--no-neutral]\n");
    return 2;
  }
  bytes = read_file(rig, &size);
  if (bytes == NULL) return fail(rig, "cannot be read");
  if (fascia_asset_load(bytes, size, &asset) != FASCIA_OK) return fail(rig, fascia_last_message());
  free(bytes);
  channels.struct_size = sizeof channels;
  if (fascia_asset_get_channels(asset, &channels) != FASCIA_OK) return fail(rig, fascia_last_message());

  stream = strcmp(stream_path, "-") == 0 ? stdin : fopen(stream_path, "r");
  if (stream == NULL) return fail(stream_path, "cannot be read");
  if (curves_path != NULL && ((part = part_of(curves_path)) == NULL || (curves = fopen(part, "w")) == NULL))
    return fail(curves_path, "cannot be written");
  if (curves != NULL) {
    fprintf(curves, "time");
    for (c = 0; c < channels.count; ++c)
      fprintf(curves, ",%s", channels.names[c]);
    fprintf(curves, "\n");
  }
  status = play(stream, stream_path, asset, &channels, curves, has_neutral);

  if (stream != stdin) fclose(stream);
  if (curves != NULL) status = put_in_place(curves, part, curves_path, status);
  free(part);
  fascia_asset_release(asset);
  return status;
}
