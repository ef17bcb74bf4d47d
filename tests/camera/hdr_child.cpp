#include "tests/camera/hdr_child.h"

#include <fcntl.h>
#include <grp.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <sstream>
#include <thread>

#include "tools/hdr/command.h"

namespace hdr::test {
namespace {

std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

void become(uid_t user) {
  if (setgroups(0, nullptr) != 0 || setgid(user) != 0 || setuid(user) != 0) _exit(126);
}

/// How long the command takes to do nothing.
double loading_seconds() {
  static const double seconds = [] {
    const auto start = std::chrono::steady_clock::now();
    run_hdr({"--version"});
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }();
  return seconds;
}

bool needs_a_start(const std::vector<std::string>& arguments) {
  return arguments.front() == "cameras" ||
         std::ranges::any_of(arguments, [](const std::string& argument) { return argument.starts_with("libcamera:"); });
}

}  // namespace

HdrChild::HdrChild(std::vector<std::string> arguments, uid_t user) {
  const bool start = needs_a_start(arguments);
  if (start) loading_ = loading_seconds();
  arguments.insert(arguments.begin(), "hdr");
  const std::string out = streams_ / "out", err = streams_ / "err";
  std::fflush(nullptr);
  start_ = std::chrono::steady_clock::now();
  process_ = fork();
  if (process_ != 0) return;
  const int to_out = open(out.c_str(), O_WRONLY | O_CREAT, 0644), to_err = open(err.c_str(), O_WRONLY | O_CREAT, 0644);
  dup2(to_out, STDOUT_FILENO);
  dup2(to_err, STDERR_FILENO);
  if (user != 0) become(user);
  std::vector<char*> words;
  for (std::string& word : arguments) words.push_back(word.data());
  words.push_back(nullptr);
  if (start) {
    execv(HDR_BINARY, words.data());
    _exit(127);
  }
  const int code = tools::main(static_cast<int>(words.size()) - 1, words.data());
  std::fflush(nullptr);
  // Without ending static objects: some wait for threads of libraries that only the parent has.
  _exit(code);
}

HdrChild::~HdrChild() {
  if (process_ <= 0) return;
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

void HdrChild::send(int signal) const {
  kill(process_, signal);
}

CommandResult HdrChild::wait() {
  using namespace std::chrono_literals;
  const auto patience = std::chrono::steady_clock::now() + 180s;
  int status = 0;
  while (waitpid(process_, &status, WNOHANG) == 0) {
    std::this_thread::sleep_for(10ms);
    if (std::chrono::steady_clock::now() > patience) kill(process_, SIGKILL);
  }
  process_ = -1;
  seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count() - loading_;
  CommandResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.out = text_of(streams_ / "out");
  result.err = text_of(streams_ / "err");
  return result;
}

double asked_in_a_child(const std::function<double()>& question) {
  int ends[2];
  if (pipe(ends) != 0) return NAN;
  const pid_t process = fork();
  if (process == 0) {
    double answer = NAN;
    try {
      answer = question();
    } catch (const std::exception& error) {
      std::cerr << error.what() << std::endl;
    }
    _exit(write(ends[1], &answer, sizeof answer) == sizeof answer ? 0 : 1);
  }
  close(ends[1]);
  double answer = NAN;
  if (read(ends[0], &answer, sizeof answer) != sizeof answer) answer = NAN;
  close(ends[0]);
  waitpid(process, nullptr, 0);
  return answer;
}

}  // namespace hdr::test
