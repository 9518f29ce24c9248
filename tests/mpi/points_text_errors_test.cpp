// What is wrong with a text is one message, the same on all ranks, that names file, line, character and
// remedy.
#include "dovetail/comm/collectives.hpp"
#include "dovetail/io/points.hpp"
#include "support/refusal.hpp"
#include "support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <sys/stat.h>

using namespace dovetail;
using namespace dovetail::testing;

namespace {

Communicator world() { return Communicator::duplicate(boost::mpi::communicator()); }

class TextErrors : public ::testing::Test {
protected:
  // Collective. With a buffer that holds the file, and with one that holds less than a line.
  void refused(const std::string &name, const std::string &content, const std::vector<std::string> &parts) {
    SCOPED_TRACE(content.substr(0, 200));
    const std::string path = folder_.make(name, content);
    for (const std::int64_t buffer : {1, 1 << 20})
      expect_refused(comm_, ErrorKind::input, path, parts,
                     [&] { read_points(comm_, std::vector{path}, {.classes = {}, .buffer_bytes = buffer}); });
    MPI_Barrier(comm_.raw());
  }
  Communicator comm_ = world();
  TemporaryFolder folder_{comm_};
};

// Wherever a line is bad, its number is right.
TEST_F(TextErrors, LineAndCharacter) {
  constexpr int count = 60;
  for (const int bad : {0, 1, 2, 20, 29, 30, 31, 40, 58, 59})
    for (const std::string &head : std::vector<std::string>{"", "x y\n", "# comment\n\n", "\xef\xbb\xbf"}) {
      std::string content = head;
      for (int i = 0; i < count; ++i)
        content += i == bad ? "12 nan\n" : i % 7 == 0 ? "1 2 # three\n" : std::to_string(i * i) + " 5\n";
      const auto line = bad + 1 + std::count(head.begin(), head.end(), '\n');
      refused("a.txt", content,
              {"line " + std::to_string(line) + ", character 4: y is NaN", "repair that line"});
    }
}

TEST_F(TextErrors, Lines) {
  refused("a.csv", "1,2\n3,inf\n", {"line 2, character 3: y is infinite"});
  refused("a.csv", "1,2\n3,1e999\n", {"line 2, character 3: y is '1e999', too large for a double"});
  refused("a.csv", "1,2,3\n3,4,nan\n", {"line 2, character 5: z is NaN"});
  refused("a.csv", "1,2,3\n3,4\n",
          {"line 2, character 4: the line has too few columns: the lines before have 3"});
  refused("a.csv", "x,y,z\n3,4\n", {"line 2, character 4", "too few columns: the line of names has 3"});
  refused("a.csv", "x,y\n3,4,5\n", {"line 2, character 5", "too many columns: the line of names has 2"});
  refused("a.xyz", "1 2\n3 4 5\n", {"line 2, character 5", "too many columns"});
  refused("a.csv", "1,2\n3;4\n",
          {"line 2, character 1: x is '3;4', which is not a number", "in the same way"});
  refused("a.csv", "1,5;2,5\n",
          {"line 1, character 1: x is '1,5'", "decimal points instead of decimal commas"});
  refused("a.txt", "1,5\t2,5\n", {"line 1, character 3: y is '5 2'", "decimal points"});
  refused("a.txt", "1 2\nsome words\n", {"line 2, character 1: x is 'some'"});
  refused("a.csv", "1,2\n,2\n", {"line 2, character 1: x is missing"});
  refused("a.csv", "1,2\n\"3\",\"4\"\n", {"line 2, character 1: x is '\"3\"'"});
  refused("a.txt", "1552\n1 2\n", {"line 1, character 1: the line has one column", "separate x and y"});
  refused("a.txt", "Points\n1 2\n", {"line 1, character 1: the line has one column"});
  refused("a.csv", "1,2\n\"3\",\"4\"\n", {"without quotes"});
  refused("a.csv", "x,y,town\n1,2,Oslo\n", {"line 2, character 5: column 3 is 'Oslo'", "leave columns out"});
  refused("a.csv", "x;y\n1.000,5;2\n", {"line 2, character 1: x is '1.000,5'", "decimal points instead"});
  refused("a.txt", "1 2\r3 4\r", {"line 1, character 4: a carriage return", "newlines"});
  refused("a.csv", "x,y\r1,2\r3,4\r", {"line 1, character 4: a carriage return"});
  refused("a.txt", "# comment\r1 2\r", {"line 1, character 10: a carriage return"});
  refused("a.txt", "1 2\r\r\n3 4\r\r\n", {"line 1, character 4: a carriage return"});
  refused("a.csv", "x,y,h\xf6he\n1,2,3\n", {"line 1", "name of column 3", "not UTF-8", "iconv"});
  refused("a.csv", "x,y,\"a\x01\"\n1,2,3\n", {"line 1", "name of column 3", "control characters"});
  refused("a.txt", std::string("1 2\n\0\n", 6), {"byte 4", "not text"});
  refused("a.txt",
          std::string("\xff\xfe"
                      "1\0 \0",
                      6),
          {"not text"});
  refused("a.txt", "1 2\n3 4\x01\n", {"line 2, character 3", "'4?'"});
  refused("a.txt", "1 2\n" + std::string((16 << 20) + 100, '1') + " 2\n",
          {"line 2, character 1", "longer than 16 MiB"});
}

TEST_F(TextErrors, Vertices) {
  const auto bad = [&](const std::string &content, const std::vector<std::string> &parts) {
    refused("a.node", content, parts);
  };
  bad("", {"the file is empty"});
  bad("# only\n", {"nothing but comments"});
  bad("three 2 0 0\n", {"line 1, character 1", "'three' is not a count"});
  bad("# c\n-3 2 0 0\n", {"line 2, character 1", "'-3' is not a count"});
  bad("1.5 2 0 0\n", {"'1.5' is not a count"});
  bad("1 3 0 0\n1 2 3 4\n", {"3 dimensions"});
  bad("1 2 0 2\n1 2 3 4 5\n", {"2 boundary markers are too many"});
  bad("1 2 0 0 0\n", {"up to 4 numbers"});
  bad("1 2 1 0\n1 2 3\n", {"line 2, character 6", "too few columns"});
  bad("1 2 0 0\n1 2 3 9\n", {"line 2, character 7", "too many columns"});
  bad("1 2 0 0\n1 2 nan\n", {"line 2, character 5: y is NaN"});
  bad("1 2 0 0\nnan 2 3\n", {"line 2, character 1: the vertex number is NaN"});
  std::string many = "50 2 0 0\n";
  for (int i = 1; i <= 50; ++i)
    many += std::to_string(i) + " 0.5 " + std::to_string(i) + "\n";
  for (const int number : {1, 2, 17, 25, 26, 33, 49, 50}) {
    std::string other = many;
    const std::string wanted = "\n" + std::to_string(number) + " 0.5";
    other.replace(other.find(wanted), wanted.size(), "\n77 0.5");
    // If the first is wrong, so is where the count begins.
    bad(other, {"line " + std::to_string(number + 1) + ", character 1: the vertex number is 77, and",
                (number == 1 ? "0" : std::to_string(number)) + " is due"});
    // A vertex that is not there at all.
    other = many;
    if (number > 1 && number < 50) {
      const auto line = other.find(wanted) + 1;
      other.erase(line, other.find('\n', line) + 1 - line);
      bad(other,
          {"line " + std::to_string(number + 1) + ", character 1", std::to_string(number) + " is due"});
    }
  }
  bad("49" + many.substr(2), {"line 51, character 1", "goes on after the 49 vertices"});
  bad("1" + many.substr(2), {"line 3, character 1", "goes on after the 1 vertices"});
  bad("0" + many.substr(2), {"line 2, character 1", "goes on after the 0 vertices"});
  bad("51" + many.substr(2), {"line 52, character 1", "ends here, with 50 of the 51 vertices"});
  bad("9007199254740992" + many.substr(2), {"ends here, with 50 of"});
}

TEST_F(TextErrors, FilesThatCannotBeOpened) {
  for (const std::string &extension : std::vector<std::string>{"xyz", "csv", "txt", "node"}) {
    const auto unreadable = [&](const std::string &path, const std::vector<std::string> &parts) {
      expect_refused(comm_, ErrorKind::input, path, parts, [&] { read_points(comm_, std::vector{path}); });
    };
    unreadable(folder_.file("missing." + extension), {"No such file", "check the name"});
    const std::string directory = folder_.file("directory." + extension);
    const std::string pipe = folder_.file("pipe." + extension);
    const std::string locked = folder_.make("locked." + extension, "1 2\n");
    if (comm_.is_root()) {
      std::filesystem::create_directory(directory);
      EXPECT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
      std::filesystem::permissions(folder_.file(""), std::filesystem::perms(0755));
      std::filesystem::permissions(locked, std::filesystem::perms::none);
    }
    MPI_Barrier(comm_.raw());
    unreadable(directory, {"Is a directory"});
    unreadable(pipe, {"not a regular file"});
    const Unprivileged unprivileged;
    unreadable(locked, {"Permission denied", "chmod"});
    MPI_Barrier(comm_.raw());
  }
}

} // namespace
