#include "app/terminal.hpp"

#include <unistd.h>

#include <cmath>

namespace almesh {

Terminal::Terminal(std::FILE* out, int dim, double length)
    : out_(out),
      is_terminal_(isatty(fileno(out)) != 0),
      length_(length),
      gradient_unit_(std::pow(length, dim - 1)),
      mu_unit_(std::pow(length, dim - 2)) {}

void Terminal::header() {
    std::fprintf(out_, "%3s  %9s  %9s  %8s  %9s  %8s  %-9s  %6s  %8s\n", "AL", "|c_D|", "|grad E|", "q", "max eta",
                 "mu", "update", "Newton", "time");
}

void Terminal::row(const CoarseStage& stage) {
    std::fprintf(out_, "%3d  %9.3e  %9.2e  %8.6f  %9.4g  %8.2e  %-9s  %6d  %7.2fs  %d nodes%s\n", stage.last.iteration,
                 stage.last.constraint_norm * length_, stage.last.gradient_norm * gradient_unit_,
                 stage.last.relative_quality, stage.last.max_distortion, stage.last.mu * mu_unit_, "coarse",
                 stage.newton_iterations, stage.last.seconds, stage.nodes,
                 stage.status == AlStatus::converged ? "" : ", not used");
    std::fflush(out_);
}

void Terminal::row(const AlIteration& it) {
    clear_live_line();
    if (it.iteration == 0)
        std::fprintf(out_, "%3d  %9.3e  %9s  %8.6f  %9.4g  %8s  %-9s  %6s  %7.2fs\n", 0, it.constraint_norm * length_,
                     "-", it.relative_quality, it.max_distortion, "-", "-", "-", it.seconds);
    else
        std::fprintf(out_, "%3d  %9.3e  %9.2e  %8.6f  %9.4g  %8.2e  %-9s  %6d  %7.2fs\n", it.iteration,
                     it.constraint_norm * length_, it.gradient_norm * gradient_unit_, it.relative_quality,
                     it.max_distortion, it.mu * mu_unit_, to_string(it.update), it.newton_iterations, it.seconds);
    std::fflush(out_);
}

void Terminal::live(int al_iteration, const NewtonStep& step) {
    if (!is_terminal_) return;
    std::fprintf(out_, "\r\033[K%3d  Newton %d  |grad E| %.2e  step %.2g  (%s)", al_iteration, step.iteration,
                 step.gradient_norm * gradient_unit_, step.step_length, to_string(step.hessian));
    std::fflush(out_);
}

void Terminal::clear_live_line() {
    if (is_terminal_) std::fputs("\r\033[K", out_);
}

}  // namespace almesh
