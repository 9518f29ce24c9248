/* Preloaded, it makes reading and writing at places of files as slow as a poor disk: DOVETAIL_TEST_DISK says how many
   bytes a second. So tests see long runs without long inputs. And where DOVETAIL_TEST_REMOVAL is set, it takes so many
   seconds to tell of the room for an output, and ten times as long to return from removing one: time for what another
   thread should not do then. */
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>
#include <time.h>
#include <unistd.h>

static void wait_seconds(double seconds) {
  const struct timespec pause = {(time_t)seconds, (long)((seconds - (double)(time_t)seconds) * 1e9)};
  nanosleep(&pause, NULL);
}

static void wait_for(ssize_t bytes) {
  const char *rate = getenv("DOVETAIL_TEST_DISK");
  if (rate != NULL && bytes > 0)
    wait_seconds((double)bytes / atof(rate));
}

/* Of outputs that are still aside, and not of what MPI removes. */
static double removal_seconds(const char *path) {
  const char *seconds = getenv("DOVETAIL_TEST_REMOVAL");
  return seconds == NULL || strstr(path, ".partial") == NULL ? 0 : atof(seconds);
}

#define DELAYED(name, pointer)                                                                               \
  ssize_t name(int file, pointer bytes, size_t count, off64_t offset) {                                      \
    ssize_t (*next)(int, pointer, size_t, off64_t);                                                          \
    *(void **)&next = dlsym(RTLD_NEXT, #name);                                                               \
    const ssize_t done = next(file, bytes, count, offset);                                                   \
    wait_for(done);                                                                                          \
    return done;                                                                                             \
  }
DELAYED(pread, void *)
DELAYED(pread64, void *)
DELAYED(pwrite, const void *)
DELAYED(pwrite64, const void *)

int statvfs(const char *path, struct statvfs *room) {
  int (*next)(const char *, struct statvfs *);
  *(void **)&next = dlsym(RTLD_NEXT, "statvfs");
  wait_seconds(removal_seconds(path));
  return next(path, room);
}

int unlink(const char *path) {
  int (*next)(const char *);
  *(void **)&next = dlsym(RTLD_NEXT, "unlink");
  const int failed = next(path);
  wait_seconds(10 * removal_seconds(path));
  return failed;
}
