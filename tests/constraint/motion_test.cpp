#include "constraint/motion.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "base/error.hpp"

using namespace almesh;

namespace {

using Point = std::array<double, 3>;

Point moved(const std::string& text, int dim, Point x) {
    const Motion motion = parse_motion(text);
    check_dimension(motion, dim);
    REQUIRE(apply(motion, dim, x.data()));
    return x;
}

void check_near(const Point& a, const Point& b, double tolerance = 1e-14) {
    for (int i = 0; i < 3; ++i) CHECK(std::abs(a[i] - b[i]) <= tolerance);
}

std::string error_of(const std::string& text) {
    try {
        parse_motion(text);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

std::string misfit_of(const std::string& text, int dim) {
    try {
        check_dimension(parse_motion(text), dim);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("single steps move a point where they should") {
    CHECK(moved("fixed", 2, {0.1, 0.2, 0}) == Point{0.1, 0.2, 0});
    CHECK(moved("translate 8 0", 2, {1, 2, 0}) == Point{9, 2, 0});
    CHECK(moved("translate 1 2 3", 3, {1, 1, 1}) == Point{2, 3, 4});
    CHECK(moved("rotate 90 about 1 0", 2, {2, 0, 0}) == Point{1, 1, 0});
    CHECK(moved("rotate 180", 2, {2, 3, 0}) == Point{-2, -3, 0});
    CHECK(moved("rotate -90", 2, {1, 0, 0}) == Point{0, -1, 0});
    CHECK(moved("rotate 3690", 2, {1, 0, 0}) == Point{0, 1, 0});
    CHECK(moved("rotate 90 axis 0 0 5", 3, {1, 0, 7}) == Point{0, 1, 7});
    CHECK(moved("rotate 90 axis 1 0 0 about 0 1 0", 3, {4, 2, 0}) == Point{4, 1, 1});
    CHECK(moved("scale 2 about 1 1", 2, {2, 3, 0}) == Point{3, 5, 0});
    CHECK(moved("scale 2 0.5", 2, {2, 3, 0}) == Point{4, 1.5, 0});
    CHECK(moved("scale 1 2 3 about 1 1 1", 3, {2, 2, 2}) == Point{2, 3, 4});
    CHECK(moved("circle 1 0 2", 2, {1, 5, 0}) == Point{1, 2, 0});
    CHECK(moved("sphere 0 0 1 2", 3, {0, 0, 0.5}) == Point{0, 0, -1});
    CHECK(moved("cylinder 0 0 5 0 0 -3 2", 3, {0.5, 0, 9}) == Point{2, 0, 9});
    const double h = std::sqrt(0.5);
    check_near(moved("rotate 45", 2, {1, 0, 0}), {h, h, 0});
    check_near(moved("rotate 30", 2, {1, 0, 0}), {std::sqrt(0.75), 0.5, 0});
    check_near(moved("rotate 120 axis 1 1 1", 3, {1, 2, 3}), {3, 1, 2}, 4e-15);
}

TEST_CASE("steps act in the order written") {
    CHECK(moved("rotate 90 about 0 0; translate 8 0", 2, {1, 0, 0}) == Point{8, 1, 0});
    CHECK(moved("translate 8 0; rotate 90 about 0 0", 2, {1, 0, 0}) == Point{0, 9, 0});
    CHECK(moved("translate 1 0 ; translate 0 1;scale 2", 2, {0, 0, 0}) == Point{2, 2, 0});
}

TEST_CASE("a motion is affine unless it projects") {
    for (const char* text : {"fixed", "translate 1 2", "rotate 30; scale 2; translate 1 0"})
        CHECK(is_affine(parse_motion(text)));
    for (const char* text : {"circle 0 0 1", "sphere 0 0 0 1", "translate 1 0 0; cylinder 0 0 0 0 0 1 2"})
        CHECK(!is_affine(parse_motion(text)));
}

TEST_CASE("rotations keep distances and orientation, their inverse undoes them") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> coordinate(-3, 3);
    for (int trial = 0; trial < 50; ++trial) {
        const Point x = {coordinate(random), coordinate(random), coordinate(random)};
        const std::string angle = std::to_string(200 * coordinate(random));
        const std::string rest = " axis 0.3 -2 1.5 about 1 -1 0.5";
        const Point y = moved("rotate " + angle + rest, 3, x);
        check_near(moved("rotate " + angle + " axis -0.3 2 -1.5 about 1 -1 0.5", 3, y), x, 1e-13);
        const double before = std::hypot(x[0] - 1, x[1] + 1, x[2] - 0.5),
                     after = std::hypot(y[0] - 1, y[1] + 1, y[2] - 0.5);
        CHECK(after == doctest::Approx(before).epsilon(1e-14));
    }
}

TEST_CASE("projections reach the surface, are idempotent and go to its closest point") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> coordinate(-3, 3);
    const auto surface_point = [&](const std::string& surface, int dim) {
        return moved(surface, dim, {coordinate(random), coordinate(random), dim == 3 ? coordinate(random) : 0});
    };
    for (const auto& [surface, dim] : {std::pair("circle 0.5 -0.25 1.5", 2), std::pair("sphere 0.5 -0.25 1 1.5", 3),
                                       std::pair("cylinder 0.5 -0.25 1 1 2 -0.5 1.5", 3)})
        for (int trial = 0; trial < 50; ++trial) {
            const Point x = {coordinate(random), coordinate(random), dim == 3 ? coordinate(random) : 0};
            const Point y = moved(surface, dim, x);
            check_near(moved(surface, dim, y), y, 1e-14);
            const Point z = surface_point(surface, dim);
            const double to_y = std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]);
            const double to_z = std::hypot(x[0] - z[0], x[1] - z[1], x[2] - z[2]);
            CHECK(to_y <= to_z + 1e-14);
        }
    const Point y = surface_point("circle 0.5 -0.25 1.5", 2);
    CHECK(std::hypot(y[0] - 0.5, y[1] + 0.25) == doctest::Approx(1.5).epsilon(1e-15));
}

TEST_CASE("a projection is undefined at the centre or on the axis, and the point stays") {
    const auto fails = [](const std::string& text, int dim, Point x) {
        const Point before = x;
        const bool undefined = !apply(parse_motion(text), dim, x.data());
        return undefined && x == before;
    };
    CHECK(fails("circle 1 2 3", 2, {1, 2, 0}));
    CHECK(fails("circle 1 2 3", 2, {1 + 1e-15, 2, 0}));
    CHECK(fails("sphere 1 2 3 4", 3, {1, 2, 3}));
    CHECK(fails("cylinder 0 0 0 1 1 1 2", 3, {0.3, 0.3, 0.3}));
    CHECK(fails("translate 1 0; circle 1 0 2", 2, {0, 0, 0}));
    CHECK(!fails("circle 1 2 3", 2, {1.001, 2, 0}));
}

TEST_CASE("2D motions leave memory beyond the two coordinates alone") {
    double x[3] = {1, 0, 7};
    CHECK(apply(parse_motion("rotate 30; translate 1 2; circle 0 0 1"), 2, x));
    CHECK(x[2] == 7);
}

TEST_CASE("very long axes do not overflow") {
    check_near(moved("rotate 90 axis 0 0 1e308", 3, {1, 0, 0}), {0, 1, 0});
    check_near(moved("rotate 120 axis 1.7e308 1.7e308 1.7e308", 3, {1, 0, 0}), {0, 1, 0});
    check_near(moved("rotate 90 axis 0 0 1e-320", 3, {1, 0, 0}), {0, 1, 0});
}

TEST_CASE("text of a motion reads back to the same motion") {
    for (const char* text : {"fixed", "translate 8 0", "translate 0.1 0.2 1e-09", "rotate 30", "rotate 30 about 1 2",
                             "rotate -12.5 axis 0 0 1 about 1 2 3", "rotate 5 axis 1 0 0", "scale 2",
                             "scale 2 3 about 1 1", "scale 1 2 3 about 0 0 1", "circle 0 0 21", "sphere 0 0 0 30",
                             "cylinder 1 2 3 0 0 1 0.5", "rotate 30 about 0 0; translate 8 0; circle 8 0 1"}) {
        const Motion motion = parse_motion(text);
        CHECK(to_string(motion) == text);
        CHECK(parse_motion(to_string(motion)) == motion);
    }
    CHECK(to_string(parse_motion("  rotate +30.0   about 0 0;translate 8 0 ")) == "rotate 30 about 0 0; translate 8 0");
    CHECK(to_string(parse_motion("rotate 30 about 1 2 3 axis 0 0 1")) == "rotate 30 axis 0 0 1 about 1 2 3");
    CHECK(!(parse_motion("scale 2") == parse_motion("scale 2 2")));
}

TEST_CASE("bad motions are refused with the reason and the form") {
    CHECK(has(error_of("translat 8 0"), "did you mean `translate`"));
    CHECK(has(error_of("translate 8"), "1 number; expected translate DX DY [DZ]"));
    CHECK(has(error_of("translate 1 2 3 4"), "4 numbers"));
    CHECK(has(error_of("translate 8, 0"), "`8,` is not a number"));
    CHECK(has(error_of("translate nan 0"), "`nan` is not a number"));
    CHECK(has(error_of("translate t 0"), "`t` is not a number (blanks separate numbers, formulas need quotes)"));
    CHECK(has(error_of("translate 1 0 about 0 0"), "`about` is not a number"));
    CHECK(has(error_of(""), "empty"));
    CHECK(has(error_of("translate 1 0;"), "empty"));
    CHECK(has(error_of("; translate 1 0"), "empty"));
    CHECK(has(error_of("fixed 1"), "1 number;"));
    CHECK(has(error_of("fixed; translate 1 0"), "`fixed` beside other steps"));
    CHECK(has(error_of("rotate"), "0 numbers"));
    CHECK(has(error_of("rotate 30 abuot 0 0"), "`abuot` is not a number"));
    CHECK(has(error_of("rotate 30 about"), "`about` needs numbers"));
    CHECK(has(error_of("rotate 30 axis about 0 0 0"), "`axis` needs numbers"));
    CHECK(has(error_of("rotate 30 about 1"), "`about` needs 2 numbers"));
    CHECK(has(error_of("rotate 30 about 1 2 3 4"), "`about` needs 2 numbers"));
    CHECK(has(error_of("rotate 30 about 1 2 about 3 4"), "`about` stands twice"));
    CHECK(has(error_of("rotate 30 axis 0 1"), "`axis` needs 3 numbers"));
    CHECK(has(error_of("rotate 30 axis 0 0 0"), "the axis is zero"));
    CHECK(has(error_of("scale 0"), "every factor must be > 0"));
    CHECK(has(error_of("scale 1 -1"), "every factor must be > 0"));
    CHECK(has(error_of("scale 2 axis 0 0 1"), "`axis` is not a number"));
    CHECK(has(error_of("circle 0 0 0"), "the radius must be > 0"));
    CHECK(has(error_of("sphere 0 0 0 -1"), "the radius must be > 0"));
    CHECK(has(error_of("cylinder 0 0 0 0 0 0 1"), "the axis is zero"));
    CHECK(has(error_of("cylinder 0 0 0 0 0 1"), "6 numbers"));
    CHECK(has(error_of("translate 1 0; sphere 0 0 0 1"), "fits no dimension"));
    CHECK(has(error_of("rotate 30 axis 0 0 1 about 0 0"), "fits no dimension"));
}

TEST_CASE("the dimension of the mesh decides which steps fit") {
    CHECK(misfit_of("fixed", 2) == "");
    CHECK(misfit_of("fixed", 3) == "");
    CHECK(misfit_of("scale 2", 2) == "");
    CHECK(misfit_of("scale 2", 3) == "");
    CHECK(has(misfit_of("translate 8 0", 3), "`translate 8 0` needs 3 components in 3D"));
    CHECK(has(misfit_of("translate 8 0 0", 2), "needs 2 components in 2D"));
    CHECK(has(misfit_of("rotate 30 about 0 0", 3), "needs `axis AX AY AZ` in 3D"));
    CHECK(has(misfit_of("rotate 30 axis 0 0 1", 2), "must not have an axis in 2D"));
    CHECK(has(misfit_of("scale 1 2", 3), "needs one factor or 3 in 3D"));
    CHECK(has(misfit_of("scale 1 2 3", 2), "needs one factor or 2 in 2D"));
    CHECK(has(misfit_of("scale 2 about 0 0", 3), "needs 3 numbers after `about` in 3D"));
    CHECK(has(misfit_of("circle 0 0 1", 3), "does not act in 3D"));
    CHECK(has(misfit_of("sphere 0 0 0 1", 2), "does not act in 2D"));
    CHECK(has(misfit_of("cylinder 0 0 0 0 0 1 1", 2), "does not act in 2D"));
}

TEST_CASE("the list of steps names every one") {
    const auto forms = motion_forms();
    for (const char* name : {"fixed", "translate", "rotate", "scale", "circle", "sphere", "cylinder"})
        CHECK(std::any_of(forms.begin(), forms.end(), [&](const Named& row) { return has(row.name, name); }));
}

TEST_CASE("a fraction of a motion turns by that part of its angle, and else goes that part of every way") {
    const auto at = [](const std::string& text, double fraction, int dim, Point x) {
        REQUIRE(apply(at_fraction(parse_motion(text), fraction), dim, x.data()));
        return x;
    };
    check_near(at("rotate 180 about 1 0", 0.5, 2, {2, 0, 0}), {1, 1, 0});
    check_near(at("rotate 720 axis 0 0 2", 0.125, 3, {1, 0, 5}), {0, 1, 5});
    check_near(at("translate 8 4", 0.25, 2, {1, 1, 0}), {3, 2, 0});
    check_near(at("scale 3 about 1 1", 0.5, 2, {2, 1, 0}), {3, 1, 0});
    check_near(at("circle 0 0 4", 0.5, 2, {2, 0, 0}), {3, 0, 0});
    check_near(at("rotate 180 about 0 0; translate 0 6", 0.5, 2, {1, 0, 0}), {0, 4, 0});
    check_near(at("fixed", 0.5, 2, {1, 2, 0}), {1, 2, 0});
    for (const char* text : {"rotate 37 about 0.1 0.2; translate 3 -1", "circle 0.3 0.2 4", "scale 2 3"})
        CHECK(at(text, 1, 2, {0.7, 0.9, 0}) == moved(text, 2, {0.7, 0.9, 0}));
}

TEST_CASE("the shorter way of a turn, and how far a motion turns") {
    CHECK(to_string(shortest(parse_motion("rotate 270; translate 1 0"))) == "rotate -90; translate 1 0");
    CHECK(to_string(shortest(parse_motion("rotate 720"))) == "rotate 0");
    CHECK(std::abs(shortest(parse_motion("rotate -180")).steps[0].numbers[0]) == 180);
    CHECK(turn(parse_motion("rotate 100; scale 2; rotate -60 about 1 0")) == 160);
    CHECK(turn(parse_motion("translate 200 0")) == 0);
}

TEST_CASE("slide is the last step, free the only one") {
    CHECK(kind_of(parse_motion("fixed")) == NodeKind::fixed);
    CHECK(kind_of(parse_motion("slide")) == NodeKind::slides);
    CHECK(kind_of(parse_motion("rotate 10; translate 1 0; slide")) == NodeKind::slides);
    CHECK(kind_of(parse_motion("free")) == NodeKind::free);
    CHECK(moved("translate 1 0; slide", 2, {1, 2, 0}) == Point{2, 2, 0});
    CHECK(has(error_of("slide; translate 1 0"), "`slide` must be the last step"));
    CHECK(has(error_of("translate 1 0; free"), "`free` beside other steps"));
    CHECK(has(error_of("fixed; slide"), "`fixed` beside other steps"));
    CHECK(has(error_of("slide 3"), "expected slide"));
    CHECK(to_string(parse_motion("rotate 10 about 1 1;slide")) == "rotate 10 about 1 1; slide");
}

TEST_CASE("twists and formulas move points, and in part") {
    check_near(moved("twist 45 axis 0 0 2", 3, {1, 0, 2}), {0, 1, 2});
    check_near(moved("twist 45 axis 0 0 1 about 0 0 1", 3, {1, 0, -1}), {0, -1, -1});
    check_near(moved("expression \"2*x + y\" \"-y\"", 2, {1, 3, 0}), {5, -3, 0});
    Point x = {1, 0, 2};
    REQUIRE(apply(at_fraction(parse_motion("twist 45 axis 0 0 1"), 0.5), 3, x.data()));
    check_near(x, {std::sqrt(0.5), std::sqrt(0.5), 2});
    x = {1, 3, 0};
    REQUIRE(apply(at_fraction(parse_motion("expression \"x\" \"y + 2\""), 0.25), 2, x.data()));
    check_near(x, {1, 3.5, 0});
    CHECK(has(misfit_of("twist 3 axis 0 0 1", 2), "must not have an axis in 2D"));
    CHECK(has(error_of("twist 3"), "it needs `axis`"));
    CHECK(has(misfit_of("expression \"x\" \"y\"", 3), "needs 3 formulas in 3D"));
    CHECK(has(error_of("expression \"x\""), "1 formula in double quotes"));
    CHECK(has(error_of("expression \"x\" \"y +\""), "column 4"));
    CHECK(!is_affine(parse_motion("twist 3 axis 0 0 1")));
    const std::string text = "expression \"x + 1\" \"y*2\"; rotate 30";
    CHECK(to_string(parse_motion(text)) == text);
}

TEST_CASE("slide along the surface of another mesh: the file, and one of its boundaries") {
    const Motion motion = parse_motion("translate 1 0; slide along \"my wall.msh\" boundary hull");
    CHECK(kind_of(motion) == NodeKind::slides);
    REQUIRE(surface_step(motion));
    CHECK(surface_step(motion)->file == "my wall.msh");
    CHECK(surface_step(motion)->boundary == "hull");
    CHECK(!file_step(motion));
    CHECK(to_string(motion) == "translate 1 0; slide along \"my wall.msh\" boundary hull");
    CHECK(surface_step(parse_motion("slide along a.msh"))->boundary.empty());
    CHECK(to_string(parse_motion("slide along a.msh boundary \"tag 7\"")) == "slide along a.msh boundary \"tag 7\"");
    CHECK(!surface_step(parse_motion("slide")));
    CHECK(!surface_step(parse_motion("file a.csv")));
    CHECK(has(error_of("slide along"), "a name is missing after `along`; expected slide [along FILE [boundary NAME]]"));
    CHECK(has(error_of("slide along a.msh boundary"), "a name is missing after `boundary`"));
    CHECK(has(error_of("slide along a.msh along b.msh"), "`along` stands twice"));
    CHECK(has(error_of("slide boundary hull"), "`boundary` is not a number"));
    CHECK(has(error_of("slide along a.msh; translate 1 0"), "`slide` must be the last step"));
    CHECK(has(error_of("onto a.stl; translate 1 0"), "`onto` must be the last step"));
    for (const char* const before : {"scale 2", "mesh a.msh", "file a.csv; scale 2"})
        CHECK(has(error_of(std::string(before) + "; onto a.stl"), "before `onto` there can only be `file NODES.csv`"));
    CHECK(to_string(parse_motion("file a.csv; onto a.stl boundary b")) == "file a.csv; onto a.stl boundary b");
}

TEST_CASE("places from a file: the first step, its name with or without quotes") {
    const Motion motion = parse_motion("file \"my nodes.csv\" displacement; rotate 5");
    REQUIRE(file_step(motion));
    CHECK(file_step(motion)->file == "my nodes.csv");
    CHECK(file_step(motion)->displacement);
    CHECK(!is_of_mesh(*file_step(motion)));
    CHECK(to_string(motion) == "file \"my nodes.csv\" displacement; rotate 5");
    CHECK(is_of_mesh(*file_step(parse_motion("mesh final.msh"))));
    CHECK(!file_step(parse_motion("rotate 5")));
    CHECK(moved("file a.csv; translate 1 0", 2, {1, 2, 0}) == Point{2, 2, 0});
    CHECK(has(error_of("rotate 5; file a.csv"), "must be the first step"));
    CHECK(has(error_of("file"), "the name of the file is missing"));
    CHECK(has(error_of("mesh a.msh displacement"), "is not a number"));
}

TEST_CASE("nodes that a file leaves out are fixed, slide or are free, as the word after `else` says") {
    CHECK(to_string(parse_motion("file a.csv else slide displacement")) == "file a.csv displacement else slide");
    CHECK(kind_of_rest(parse_motion("file a.csv else fixed")) == NodeKind::target);
    CHECK(kind_of_rest(parse_motion("file a.csv else slide; rotate 5")) == NodeKind::slides);
    CHECK(kind_of_rest(parse_motion("file a.csv else free")) == NodeKind::free);
    CHECK(kind_of_rest(parse_motion("file a.csv else free; slide")) == NodeKind::slides);  // as all others
    CHECK(kind_of_rest(parse_motion("file a.csv")) == NodeKind::target);
    CHECK(kind_of(parse_motion("file a.csv else free")) == NodeKind::target);
    for (const std::string text : {"file a.csv else", "file a.csv else rotate", "file a.csv else expression",
                                   "file a.csv else mesh", "file a.csv else away"})
        CHECK(has(error_of(text), "`else` needs one of the words fixed, slide, free"));
    CHECK(has(error_of("file a.csv else free else free"), "`else` is not a number"));
    CHECK(has(error_of("mesh a.msh else free"), "`else` is not a number"));
}

TEST_CASE("any turn is two halves of it, one after the other") {
    for (int angle = -720; angle <= 720; angle += 10) {
        const std::string half = "rotate " + std::to_string(angle / 2) + " about 1 2";
        check_near(moved("rotate " + std::to_string(angle) + " about 1 2", 2, {3, 1, 0}),
                   moved(half + "; " + half, 2, {3, 1, 0}));
    }
}

TEST_CASE("numbers that are formulas of t, formulas that name t, files by the number of the frame") {
    const auto at = [](const std::string& text, double t, Point x) {
        const Motion motion = at_time(parse_motion(text), t, 7);
        CHECK(apply(motion, 3, x.data()));
        return x;
    };
    CHECK(at("translate \"2*t\" 1 \"t^2\"", 3, {1, 1, 1}) == Point{7, 2, 10});
    CHECK(at("translate \"pi - pi + 2\" 1 0", 3, {1, 1, 1}) == Point{3, 2, 1});
    check_near(at("rotate \"90*t\" axis \"1 - t\" 0 \"t\" about \"t\" 0 0", 1, {2, 0, 0}), {1, 1, 0});
    CHECK(at("expression \"x + t*y\" \"t\" \"z\"", 2, {1, 3, 5}) == Point{7, 2, 5});
    const Motion motion = parse_motion("file wing-%04d.csv; rotate \"90*t\" about 1 \"2*t\"");
    CHECK(to_string(motion) == "file wing-%04d.csv; rotate \"90*t\" about 1 \"2*t\"");
    CHECK(parse_motion(to_string(motion)) == motion);
    CHECK(depends_on_time(motion));
    CHECK(!depends_on_time(parse_motion("rotate \"2*pi\"")));
    CHECK(at_time(motion, 0, 12).steps[0].file == "wing-0012.csv");
    CHECK(at_time(parse_motion("file w%d"), 0, 12).steps[0].file == "w12");
    CHECK(at_time(parse_motion("file 50%-done"), 0, 12).steps[0].file == "50%-done");
    CHECK(turn(at_time(motion, 2, 1)) == 180);
    for (const char* text : {"translate \"1/t\" 0", "scale \"t\"", "rotate 1 axis 0 0 \"t\"", "circle 0 0 \"t\""}) {
        CHECK(error_of(text) == "");
        CHECK_NOTHROW(at_time(parse_motion(text), 1, 1));
        CHECK_THROWS_AS(at_time(parse_motion(text), 0, 1), UsageError);
    }
    CHECK(has(error_of("translate \"2*x\" 0"),
              "`translate`: the formula \"2*x\" of a number may name t and constants alone"));
    CHECK(has(error_of("scale \"1 - 1\""), "every factor must be > 0"));
    CHECK(has(error_of("rotate \"90*\""), "column 4"));
}

TEST_CASE("which turns a mesh that follows leads to") {
    const auto leads = [](double from, double to, bool as_written) {
        const auto turned = [](double t) { return at_time(parse_motion("translate \"t\" 0; rotate \"t\""), t, 1); };
        return leads_to(turned(from), turned(to), as_written);
    };
    for (const double turns : {0.0, 360.0, -720.0}) {
        CHECK(leads(turns + 10, turns + 100, false));
        CHECK(!leads(turns + 10, turns + 101, false));
        CHECK(leads(turns + 150, turns + 180, false));
        CHECK(leads(turns - 150, turns - 180, false));
        CHECK(!leads(turns + 150, turns + 190, false));
        CHECK(!leads(turns + 180, turns + 190, false));
        CHECK(leads(turns + 190, turns + 200, false));
        CHECK(leads(turns + 350, turns + 370, false));
        CHECK(leads(turns + 150, turns + 190, true));
        CHECK(!leads(turns, turns + 360, true));
    }
}
