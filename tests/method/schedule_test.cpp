#include "method/schedule.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>

using namespace almesh;

namespace {

constexpr double one_squared = 4;  // |1|^2

AugmentedLagrangianParams with(Algorithm algorithm) {
    AugmentedLagrangianParams params;
    params.algorithm = algorithm;
    params.mu0 = 1000;
    params.omega0 = 1e-2;
    params.epsilon0 = 1e-3;
    params.omega_star = 1e-8;
    params.epsilon_star = 1e-16;
    return params;
}

void check(const Schedule& s, double mu, double omega, double epsilon) {
    CHECK(s.mu == doctest::Approx(mu).epsilon(1e-14));
    CHECK(s.omega == doctest::Approx(omega).epsilon(1e-14));
    CHECK(s.epsilon == doctest::Approx(epsilon).epsilon(1e-14));
}

}  // namespace

TEST_CASE("Algorithm 1 read consistently, by hand: m = 10, then 1000, then 1e5") {
    Schedule s(with(Algorithm::paper), 0, one_squared, 1);
    check(s, 4000, 1e-2, 1e-3);
    CHECK(s.penalty() == s.mu);
    CHECK(s.reduction == 1);
    CHECK(s.least_omega == 1e-8);
    CHECK(s.tighten(1e-4, 0) == AlUpdate::multipliers);  // 11-14 with m = 10
    check(s, 4000, 1e-3, 1e-3 / std::pow(10, 0.9));
    CHECK(s.raise_penalty() == AlUpdate::penalty);  // 17-20: m/m0 = 100, from the first tolerances
    check(s, 4e5, 1e-4, 1e-3 / std::pow(100, 0.1));
    CHECK(s.tighten(0, 0) == AlUpdate::multipliers);  // with m = 1000
    check(s, 4e5, 1e-7, 1e-3 / std::pow(100, 0.1) / std::pow(1000, 0.9));
    CHECK(s.raise_penalty() == AlUpdate::penalty);
    check(s, 4e7, 1e-6, 1e-3 / std::pow(1e4, 0.1));
    CHECK(s.ends(true, true));
    CHECK_FALSE(s.ends(true, false));
    CHECK_FALSE(s.ends(false, true));
    CHECK_FALSE(s.ends(false, false));
}

TEST_CASE("Algorithm 1 as printed, by hand: penalty mu^2, tolerances that grow, the end where one test holds") {
    Schedule s(with(Algorithm::literal), 0, one_squared, 1);
    check(s, 4000, 1e-2, 1e-3);
    CHECK(s.penalty() == 4000.0 * 4000.0);
    CHECK(s.reduction == 1);
    CHECK(s.least_omega == 0);
    CHECK(s.tighten(1e-4, 0) == AlUpdate::multipliers);
    check(s, 4000, 1e-2 / 4000, 1e-3 / std::pow(10, 0.9));  // omega by mu
    CHECK(s.raise_penalty() == AlUpdate::penalty);          // m0/m = 1/100
    check(s, 4e5, 1, 1e-3 * std::pow(100, 0.1));
    CHECK(s.penalty() == doctest::Approx(16e10).epsilon(1e-14));
    CHECK(s.tighten(0, 0) == AlUpdate::multipliers);
    check(s, 4e5, 1 / 4e5, 1e-3 * std::pow(100, 0.1) / std::pow(1000, 0.9));
    CHECK(s.ends(true, true));
    CHECK(s.ends(true, false));
    CHECK(s.ends(false, true));
    CHECK_FALSE(s.ends(false, false));
}

TEST_CASE("the adaptive schedule: mu grows too where boundary nodes hardly come nearer to their places") {
    Schedule s(with(Algorithm::adaptive), 0, one_squared, 1);
    CHECK(s.tighten(0, 5) == AlUpdate::multipliers);  // against nothing
    CHECK(s.mu == 4e5);
    CHECK(s.omega == doctest::Approx(1e-6).epsilon(1e-14));  // the constraint does not hold at every node
    CHECK(s.tighten(0, 0.49) == AlUpdate::multipliers);      // by more than ten
    CHECK(s.tighten(0, 0.1) == AlUpdate::both);
    CHECK(s.mu == 4e6);
    CHECK(s.tighten(0, 1e-3) == AlUpdate::multipliers);  // wall_tolerance
    CHECK(s.omega == 1e-8);
}

TEST_CASE("the adaptive schedule, by hand: mu grows where |c_D| fell by less than ten, omega falls until c_D holds") {
    Schedule s(with(Algorithm::adaptive), 0, one_squared, 1);
    CHECK(s.mu == 4e5);
    CHECK(s.penalty() == 4e5);
    CHECK(s.omega == doctest::Approx(1e-5).epsilon(1e-14));
    CHECK(std::isinf(s.epsilon));  // line 9 always holds
    CHECK(s.reduction == 0.1);
    CHECK(s.least_omega == 1e-8);
    CHECK(s.tighten(0.0099, 0) == AlUpdate::multipliers);  // |c| fell by more than ten
    CHECK(s.mu == 4e5);
    CHECK(s.omega == doctest::Approx(1e-6).epsilon(1e-14));
    CHECK(s.tighten(0.0001, 0) == AlUpdate::both);  // against 0.0099: by just less than ten
    CHECK(s.mu == 4e6);
    CHECK(s.omega == doctest::Approx(1e-7).epsilon(1e-14));
    CHECK(s.tighten(1e-16, 0) == AlUpdate::multipliers);  // the constraint holds
    CHECK(s.mu == 4e6);
    CHECK(s.omega == 1e-8);
    CHECK(s.tighten(0.9e-16, 0) == AlUpdate::multipliers);  // it need not fall further
    CHECK(s.mu == 4e6);
    CHECK(s.omega == 1e-8);
    CHECK(s.ends(true, true));
    CHECK_FALSE(s.ends(true, false));
    CHECK_FALSE(s.ends(false, true));
}

TEST_CASE("a first penalty that is given counts for every schedule, in units of |1|^2") {
    for (const Algorithm algorithm : {Algorithm::adaptive, Algorithm::paper, Algorithm::literal}) {
        Schedule s(with(algorithm), 50, one_squared, 1);
        CHECK(s.mu == 200);
        s.raise_penalty();
        CHECK(s.mu == doctest::Approx(algorithm == Algorithm::adaptive ? 2000 : 20000).epsilon(1e-14));
    }
}
