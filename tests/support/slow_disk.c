/* Preloaded, it makes reading and writing at places of files as slow as a poor disk: DOVETAIL_TEST_DISK says how many
   bytes a second. So tests see long runs without long inputs. */
#include <dlfcn.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

static void wait_for(ssize_t bytes) {
  const char *rate = getenv("DOVETAIL_TEST_DISK");
  if (rate == NULL || bytes <= 0)
    return;
  const double seconds = (double)bytes / atof(rate);
  const struct timespec pause = {(time_t)seconds, (long)((seconds - (double)(time_t)seconds) * 1e9)};
  nanosleep(&pause, NULL);
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
