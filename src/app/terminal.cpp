#include "app/terminal.hpp"

#include <unistd.h>

#include "method/continuation.hpp"

namespace almesh {

Terminal::Terminal(std::FILE* out, int dim, double length)
    : out_(out), is_terminal_(isatty(fileno(out)) != 0), units_{dim, length} {}

void Terminal::header() {
    std::fprintf(out_, "%3s  %9s  %9s  %8s  %9s  %8s  %-9s  %6s  %8s\n", "AL", "|c_D|", "|grad E|", "q", "max eta",
                 "mu", "update", "Newton", "time");
}

void Terminal::row(const CoarseStage& stage) {
    const char* const used = stage.status == AlStatus::converged ? "" : ", not used";
    row(stage.last, "coarse", stage.newton_iterations, "  " + std::to_string(stage.nodes) + " nodes" + used);
}

void Terminal::row(const AlIteration& it) {
    clear_live_line();
    if (it.iteration > 0) return row(it, to_string(it.update), it.newton_iterations, "");
    std::fprintf(out_, "%3d  %9.3e  %9s  %8.6f  %9.4g  %8s  %-9s  %6s  %7.2fs\n", 0,
                 units_.distance(it.constraint_norm), "-", it.relative_quality, it.max_distortion, "-", "-", "-",
                 it.seconds);
    std::fflush(out_);
}

void Terminal::row(const AlIteration& it, const char* update, int newton_iterations, const std::string& note) {
    std::fprintf(out_, "%3d  %9.3e  %9.2e  %8.6f  %9.4g  %8.2e  %-9s  %6d  %7.2fs%s\n", it.iteration,
                 units_.distance(it.constraint_norm), units_.gradient(it.gradient_norm), it.relative_quality,
                 it.max_distortion, units_.penalty(it.mu), update, newton_iterations, it.seconds, note.c_str());
    std::fflush(out_);
}

void Terminal::live(int al_iteration, const NewtonStep& step) {
    if (!is_terminal_) return;
    std::fprintf(out_, "\r\033[K%3d  Newton %d  |grad E| %.2e  step %.2g  (%s)", al_iteration, step.iteration,
                 units_.gradient(step.gradient_norm), step.step_length, to_string(step.hessian));
    std::fflush(out_);
}

void Terminal::clear_live_line() {
    if (is_terminal_) std::fputs("\r\033[K", out_);
}

}  // namespace almesh
