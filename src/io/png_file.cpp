#include "png_file.hpp"

#include <csetjmp>
#include <new>
#include <png.h>
#include <stdexcept>
#include <type_traits>

// libpng leaves a function that fails by longjmp, so no function below that calls it between setjmp and its
// end has anything to destroy.

namespace dovetail {
namespace {

static_assert(sizeof(Colour) == 3 && std::is_trivially_copyable_v<Colour>, "a pixel as PNG has it");

[[noreturn]] void fail() { throw std::runtime_error("libpng could not encode the picture"); }

} // namespace

void PngEncoder::keep(png_struct_def *png, unsigned char *bytes, std::size_t count) {
  auto *const encoder = static_cast<PngEncoder *>(png_get_io_ptr(png));
  bool kept = true;
  try {
    const auto *const begin = reinterpret_cast<const std::byte *>(bytes);
    encoder->encoded_.insert(encoder->encoded_.end(), begin, begin + count);
  } catch (const std::bad_alloc &) { // must not cross libpng's C
    kept = false;
  }
  if (!kept)
    png_error(png, "no memory");
}

void PngEncoder::keep_nothing(png_struct_def * /*png*/) {}

PngEncoder::PngEncoder(int width, int height) : width_(static_cast<std::size_t>(width)) {
  png_ = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  about_ = png_ != nullptr ? png_create_info_struct(png_) : nullptr;
  if (about_ == nullptr) {
    png_destroy_write_struct(&png_, &about_);
    throw std::bad_alloc();
  }
  if (setjmp(png_jmpbuf(png_)) != 0) {
    png_destroy_write_struct(&png_, &about_);
    fail();
  }
  png_set_write_fn(png_, this, keep, keep_nothing);
  png_set_IHDR(png_, about_, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  // Flat colours and lines: as they are they compress to half of what any prediction leaves.
  png_set_filter(png_, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
  png_write_info(png_, about_);
}

PngEncoder::~PngEncoder() { png_destroy_write_struct(&png_, &about_); }

void PngEncoder::add_rows(std::span<const Colour> pixels) {
  if (setjmp(png_jmpbuf(png_)) != 0)
    fail();
  for (std::size_t begin = 0; begin < pixels.size(); begin += width_)
    png_write_row(png_, reinterpret_cast<png_const_bytep>(pixels.data() + begin));
}

void PngEncoder::finish() {
  if (setjmp(png_jmpbuf(png_)) != 0)
    fail();
  png_write_end(png_, about_);
}

std::vector<std::byte> PngEncoder::take() {
  std::vector<std::byte> bytes;
  bytes.swap(encoded_);
  return bytes;
}

} // namespace dovetail
