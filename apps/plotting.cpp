#include "apps/plotting.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "apps/gnuplot.h"
#include "physics/core/atomic_file.h"
#include "physics/core/error.h"

namespace crossgait::apps {
namespace {

// Okabe and Ito's palette without yellow, which is faint on white.
constexpr std::array<const char*, kColours> kPalette{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                     "#56b4e9", "#e69f00", "#333333"};
constexpr int kTitleHeight = 40;  // px
// Around the axes of a panel, px: room for tick marks and labels, legend and title.
constexpr int kLeft = 100, kRight = 20, kColourBar = 90, kTop = 54, kBottom = 56;

const char* colour_code(int colour) { return kPalette[static_cast<std::size_t>(colour % kColours)]; }

void append_size(std::string& script, const char* axis, double low, double high, int total) {
  fmt::format_to(std::back_inserter(script), "set {}margin at screen {:.6f}\n", axis, low / total);
  const char* other = axis[0] == 'l' ? "r" : "t";
  fmt::format_to(std::back_inserter(script), "set {}margin at screen {:.6f}\n", other, high / total);
}

struct Range {
  double low = HUGE_VAL, high = -HUGE_VAL;
  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// A twentieth wider on either side, and never empty.
  Range padded() const {
    if (low > high) return {0, 1};
    const double pad = high - low > 1e-9 * std::max(std::abs(low), std::abs(high))
                           ? 0.05 * (high - low)
                           : std::max(0.1 * std::abs(high), 1e-3);
    return {low - pad, high + pad};
  }
  /// The same on a logarithmic axis.
  Range padded_log() const {
    if (low > high) return {1, 10};
    const double pad = std::pow(high / low > 1 + 1e-9 ? high / low : 10, 0.05);
    return {low / pad, high * pad};
  }
};

/// What the contents of a panel span along axis 0 (x) or 1 (y).
Range contents(const Panel& panel, std::size_t axis) {
  Range range;
  const bool positive = axis == 0 ? panel.x_log : panel.y_log;
  const auto include = [&](double value) {
    if (!positive || value > 0) range.include(value);
  };
  for (const Series& series : panel.series) {
    for (const PlotPoint& p : series.points) include(p[axis]);
  }
  for (const Bars& bars : panel.bars) {
    for (const Bars::Bar& bar : bars.bars) {
      include(bar.min[axis]);
      include(bar.max[axis]);
    }
  }
  if (panel.shades) {
    range.include(panel.shades->min[axis]);
    range.include(panel.shades->max[axis]);
  }
  return range;
}

std::string style_of(const Series& series) {
  switch (series.style) {
    case Series::Style::kLine:
      return fmt::format("lines linewidth {:g}", series.width);
    case Series::Style::kDashed:
      return fmt::format("lines linewidth {:g} dashtype (6,4)", 0.75 * series.width);
    case Series::Style::kLinePoints:
      return fmt::format("linespoints linewidth {:g} pointtype 7 pointsize {:g}", series.width,
                         0.2 + 0.2 * series.width);
    case Series::Style::kPoints:
      break;
  }
  return fmt::format("points pointtype 7 pointsize {:g}", 0.28 * series.width);
}

/// The curves of one panel: data blocks, and a plot command that refers to them.
class PlotCommand {
 public:
  void add(const ShadeMap& map) {
    begin_block();
    std::size_t i = 0;
    for (int iy = 0; iy < map.count[1]; ++iy) {
      for (int ix = 0; ix < map.count[0]; ++ix, ++i) {
        const double x = map.min[0] + (map.max[0] - map.min[0]) * ix / (map.count[0] - 1);
        const double y = map.min[1] + (map.max[1] - map.min[1]) * iy / (map.count[1] - 1);
        const std::string value = map.values[i] ? fmt::format("{:.5g}", *map.values[i]) : "NaN";
        fmt::format_to(std::back_inserter(data_), "{:.9g} {:.9g} {}\n", x, y, value);
      }
    }
    end_block("using 1:2:3 with image", "");
  }

  void add(const Bars& bars) {
    if (bars.bars.empty()) return;
    begin_block();
    for (const Bars::Bar& b : bars.bars) {
      fmt::format_to(std::back_inserter(data_), "{:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n",
                     (b.min[0] + b.max[0]) / 2, (b.min[1] + b.max[1]) / 2, b.min[0], b.max[0], b.min[1],
                     b.max[1]);
    }
    const char* style =
        bars.filled ? "fillstyle solid noborder linecolor rgb" : "fillstyle empty linewidth 2 linecolor rgb";
    end_block(fmt::format("with boxxyerror {} '{}'", style, colour_code(bars.colour)), bars.label);
  }

  void add(const Series& series) {
    if (series.points.empty()) return;
    begin_block();
    for (const auto& [x, y] : series.points) {
      fmt::format_to(std::back_inserter(data_), "{:.9g} {:.9g}\n", x, y);
    }
    end_block(fmt::format("with {} linecolor rgb '{}'", style_of(series), colour_code(series.colour)),
              series.label);
  }

  std::string str() const {
    // Gnuplot has no empty plot: a curve without points draws the axes.
    return data_ + (plot_.empty() ? "plot NaN notitle\n" : "plot " + plot_ + "\n");
  }

 private:
  void begin_block() { data_ += fmt::format("$block{} << END_OF_BLOCK\n", ++blocks_); }
  void end_block(const std::string& how, const std::string& label) {
    data_ += "END_OF_BLOCK\n";
    plot_ += fmt::format("{}$block{} {} {}", plot_.empty() ? "" : ", ", blocks_, how,
                         label.empty() ? "notitle" : "title " + gnuplot_quoted(label));
  }

  std::string data_, plot_;
  int blocks_ = 0;
};

/// The space of one panel in a figure, px from the lower left.
struct Place {
  double left, right, bottom, top;
};

/// With equal scales, the axes shrink around their middle until one unit is as long along y as along x.
Place fit(const Place& space, const Range& x, const Range& y, bool equal_scales) {
  if (!equal_scales) return space;
  const double width = space.right - space.left, height = space.top - space.bottom;
  const double scale = std::min(width / (x.high - x.low), height / (y.high - y.low));
  const double dx = (width - scale * (x.high - x.low)) / 2, dy = (height - scale * (y.high - y.low)) / 2;
  return {space.left + dx, space.right - dx, space.bottom + dy, space.top - dy};
}

/// What the axes of a panel show. Along x no more than there is, except where scales are equal.
std::pair<Range, Range> ranges(const Panel& panel) {
  const auto given = [](const PlotPoint& range) { return Range{range[0], range[1]}; };
  const Range all_x = contents(panel, 0), all_y = contents(panel, 1);
  Range x = panel.x_log                                       ? all_x.padded_log()
            : panel.equal_scales || !(all_x.high > all_x.low) ? all_x.padded()
                                                              : all_x;
  Range y = panel.y_log ? all_y.padded_log() : all_y.padded();
  if (panel.x_range) x = given(*panel.x_range);
  if (panel.y_range) y = given(*panel.y_range);
  return {x, y};
}

/// Tick marks of a logarithmic axis: decades, every few of them on a long axis, with steps between on a short
/// one.
std::string log_tics(const Range& range) {
  const double decades = std::log10(range.high / range.low);
  const int every = std::max(1, static_cast<int>(std::ceil(decades / 8)));
  std::vector<double> steps{1};
  if (decades < 3) steps = {1, 2, 5};
  std::string tics;
  for (int d = static_cast<int>(std::floor(std::log10(range.low))); d <= std::log10(range.high); d += every) {
    for (const double step : steps) {
      const double at = step * std::pow(10, d);
      if (at < range.low * (1 - 1e-9) || at > range.high * (1 + 1e-9)) continue;
      tics += fmt::format("{}'{:g}' {:.9g}", tics.empty() ? "" : ", ", at, at);
    }
  }
  return "(" + tics + ")";
}

void append_panel(std::string& script, const Panel& panel, const Place& space, int width, int height) {
  const auto out = std::back_inserter(script);
  const auto [sound_x, y] = ranges(panel);
  const Place place = fit({space.left + kLeft, space.right - (panel.shades ? kColourBar : kRight),
                           space.bottom + kBottom, space.top - kTop},
                          sound_x, y, panel.equal_scales);
  append_size(script, "l", place.left, place.right, width);
  append_size(script, "b", place.bottom, place.top, height);
  fmt::format_to(out, "set title {} offset 0,.5 font ',13'\nset xlabel {}\nset ylabel {}\n",
                 gnuplot_quoted(panel.title), gnuplot_quoted(panel.x_label), gnuplot_quoted(panel.y_label));
  fmt::format_to(out, "set xrange [{:.9g}:{:.9g}]\n", sound_x.low, sound_x.high);
  fmt::format_to(out, "set yrange [{:.9g}:{:.9g}]\n", panel.y_down ? y.high : y.low,
                 panel.y_down ? y.low : y.high);
  script += "unset logscale\nset xtics autofreq\nunset ytics\n";
  if (panel.x_tics > 0) fmt::format_to(out, "set xtics {:.9g}\n", panel.x_tics);
  if (panel.x_log) fmt::format_to(out, "set logscale x\nset xtics {}\n", log_tics(sound_x));
  if (panel.y_log) script += "set logscale y\n";
  if (panel.y_names.empty()) {
    fmt::format_to(out, "set ytics nomirror out scale .5 {}\n", panel.y_log ? log_tics(y) : "autofreq");
  } else {
    std::string names;
    for (const auto& [at, label] : panel.y_names) {
      names += fmt::format("{}{} {:.9g}", names.empty() ? "" : ", ", gnuplot_quoted(label), at);
    }
    fmt::format_to(out, "set ytics nomirror out scale .5 ({})\n", names);
  }
  PlotCommand plot;
  if (panel.shades) {
    fmt::format_to(out, "set cblabel {}\n", gnuplot_quoted(panel.shades->label));
    plot.add(*panel.shades);
  }
  for (const Bars& bars : panel.bars) plot.add(bars);
  for (const Series& series : panel.series) plot.add(series);
  script += plot.str();
}

/// One scale for all shades of a figure, from zero, so that they compare.
double brightest(const Figure& figure) {
  double highest = 0;
  for (const Figure::Row& row : figure.rows) {
    for (const Panel& panel : row.panels) {
      if (!panel.shades) continue;
      for (const auto& value : panel.shades->values) highest = std::max(highest, value.value_or(0));
    }
  }
  return highest > 0 ? highest : 1;
}

std::string make_script(const Figure& figure, bool png) {
  int height = kTitleHeight;
  for (const Figure::Row& row : figure.rows) height += row.height;
  // "noenhanced": an underscore in a name is an underscore.
  std::string script = fmt::format(
      "set terminal {} noenhanced font 'DejaVu Sans,11' background '#ffffff' "
      "size {},{}\n",
      png ? "pngcairo" : "svg", figure.width, height);
  script +=
      "set encoding utf8\n"
      "set border 3 linecolor rgb '#555555'\n"
      "set tics nomirror out scale .5\n"
      "set grid linecolor rgb '#dddddd' linetype 1 linewidth .6\n"
      "set key at graph 1,graph 1.0 right bottom horizontal nobox samplen 1.2 width -.5 maxrows 1 font "
      "',10'\n"
      "set palette defined (0 '#440154', 1 '#3b528b', 2 '#21918c', 3 '#5ec962', 4 '#fde725')\n";
  fmt::format_to(
      std::back_inserter(script),
      "set cbrange [0:{:.9g}]\nset multiplot\nset label 1 {} at screen .5,screen {:.6f} center font ',15'\n",
      brightest(figure), gnuplot_quoted(figure.title), 1 - 0.55 * kTitleHeight / height);
  double top = height - kTitleHeight;
  for (const Figure::Row& row : figure.rows) {
    const double share =
        static_cast<double>(figure.width) / static_cast<double>(std::max(row.panels.size(), row.columns));
    for (std::size_t i = 0; i < row.panels.size(); ++i) {
      const double left = share * static_cast<double>(i);
      append_panel(script, row.panels[i], {left, left + share, top - row.height, top}, figure.width, height);
      script += "unset label 1\n";
    }
    top -= row.height;
  }
  return script + "unset multiplot\n";
}

}  // namespace

std::size_t Figure::panel_count() const {
  std::size_t count = 0;
  for (const Row& row : rows) count += row.panels.size();
  return count;
}

void check_plot_path(const std::string& path, const std::string& option) {
  if (path.ends_with(".svg") || path.ends_with(".png")) return;
  throw ConfigError("command line", option, "a file name that ends in .svg or .png", "\"" + path + "\"");
}

void draw(const Figure& figure, const std::string& path) {
  check_plot_path(path, "picture");
  write_file_atomically(path, run_gnuplot(make_script(figure, path.ends_with(".png"))));
}

}  // namespace crossgait::apps
