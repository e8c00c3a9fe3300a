#include <algorithm>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "tests/support/rendering/catalogue.h"

namespace mapweld::rendered {
namespace {

cv::Mat paint_door(Random& random, Random& notices) {
  const int w = 256;
  const int h = 540;
  Colour colour = Hsv{random.uniform(0, 360), random.uniform(0.05, 0.55), random.uniform(0.25, 0.75)};
  if (random.chance(0.5)) colour = Hsv{random.uniform(18, 36), random.uniform(0.35, 0.65), random.uniform(0.35, 0.7)};
  cv::Mat door = canvas(w, h, colour);
  add_noise(door, 24, 5, random.next());
  const bool handle_left = random.chance(0.5);
  switch (random.below(5)) {
    case 0:  // panelled
      for (const double y : {0.06, 0.56}) {
        outline(door, w * 0.14, h * y, w * 0.72, h * 0.38, scaled(colour, 0.65), 5);
        outline(door, w * 0.14 + 6, h * y + 6, w * 0.72 - 12, h * 0.38 - 12, scaled(colour, 1.25), 3);
      }
      break;
    case 1:  // a narrow pane beside the handle
      fill(door, handle_left ? w * 0.62 : w * 0.18, h * 0.12, w * 0.18, h * 0.5, rgb(60, 70, 76));
      fill(door, handle_left ? w * 0.64 : w * 0.2, h * 0.13, w * 0.08, h * 0.48, rgb(140, 155, 160));
      outline(door, handle_left ? w * 0.62 : w * 0.18, h * 0.12, w * 0.18, h * 0.5, scaled(colour, 0.5), 4);
      break;
    case 2:  // a square pane
      fill(door, w * 0.3, h * 0.12, w * 0.4, h * 0.2, rgb(96, 112, 118));
      stroke(door, w * 0.34, h * 0.3, w * 0.62, h * 0.14, rgb(170, 186, 190), 9);
      outline(door, w * 0.3, h * 0.12, w * 0.4, h * 0.2, rgb(40, 40, 40), 5);
      break;
    case 3:  // boards
      for (int i = 1; i < 5; ++i) fill(door, w * i / 5.0, 0, 3, h, scaled(colour, 0.7));
      break;
    default:
      break;
  }
  if (random.chance(0.5)) fill(door, w * 0.04, h * 0.88, w * 0.92, h * 0.1, rgb(165, 168, 172));  // kick plate
  const double x = handle_left ? w * 0.1 : w * 0.9;
  fill(door, x - 7, h * 0.46, 14, h * 0.1, rgb(190, 190, 190));
  fill(door, handle_left ? x - 5 : x - 36, h * 0.485, 42, 8, rgb(225, 225, 225));
  fill(door, handle_left ? x - 5 : x - 36, h * 0.498, 42, 3, rgb(70, 70, 70));
  disc(door, x, h * 0.54, 4, rgb(30, 30, 30));
  if (notices.chance(0.45)) {  // a sheet taped to it
    const double px = w * notices.uniform(0.25, 0.5);
    const double py = h * notices.uniform(0.34, 0.42);
    fill(door, px, py, 60, 82, rgb(246, 246, 240));
    fill(door, px + 6, py + 6, 30, 8, any_colour(notices));
    print_lines(door, px + 6, py + 20, 48, 56, 8, rgb(60, 60, 60), notices);
  }
  outline(door, 0, 0, w, h, scaled(colour, 0.55), 4);
  return door;
}

cv::Mat paint_notice_board(Random& random) {
  const int w = 480;
  const int h = 320;
  cv::Mat board = canvas(w, h, random.chance(0.6) ? rgb(176, 132, 84) : any_colour(random));
  add_noise(board, 4, 14, random.next());
  const int notes = random.between(9, 16);
  for (int i = 0; i < notes; ++i) {
    const double nw = random.uniform(44, 100);
    const double nh = random.uniform(40, 110);
    const double x = random.uniform(12, w - nw - 12);
    const double y = random.uniform(12, h - nh - 12);
    const Colour paper =
        random.chance(0.6) ? rgb(245, 244, 238) : Hsv{random.uniform(0, 360), random.uniform(0.2, 0.7), 0.95};
    fill(board, x + 3, y + 3, nw, nh, rgb(80, 60, 40));
    fill(board, x, y, nw, nh, paper);
    if (random.chance(0.5)) {
      fill(board, x + 5, y + 6, nw - 10, nh * 0.4, any_colour(random));
      const double spot = random.uniform(0.3, 0.7);
      disc(board, x + nw * spot, y + nh * 0.25, nh * 0.12, any_colour(random));
      print_lines(board, x + 5, y + nh * 0.55, nw - 10, nh * 0.4, 8, rgb(60, 60, 66), random);
    } else {
      const std::string word = made_up_word(random);
      text(board, word, x + 6, y + 18, 11, any_colour(random));
      print_lines(board, x + 5, y + 26, nw - 10, nh - 32, 8, rgb(60, 60, 66), random);
    }
    disc(board, x + nw / 2, y + 4, 3.5, Hsv{random.uniform(0, 360), 0.9, 0.9});
  }
  outline(board, 0, 0, w, h, random.chance(0.5) ? rgb(140, 142, 146) : rgb(96, 66, 40), 9);
  return board;
}

cv::Mat paint_whiteboard(Random& random) {
  const int w = 480;
  const int h = 300;
  cv::Mat board = canvas(w, h, rgb(238, 240, 242));
  add_noise(board, 120, 5, random.next());
  const std::vector<Colour> pens{rgb(30, 40, 120), rgb(180, 30, 40), rgb(20, 110, 60), rgb(30, 30, 34)};
  for (int i = 0; i < 4; ++i) {
    const Colour& pen = random.pick(pens);
    const double x = random.uniform(20, w * 0.65);
    const double y = random.uniform(30, h * 0.7);
    switch (random.below(3)) {
      case 0:
        for (int k = 0; k < 4; ++k) text(board, made_up_word(random), x, y + 22 * k, 12, pen, 2);
        break;
      case 1: {
        double px = x;
        double py = y;
        for (int k = 0; k < 5; ++k) {
          const double nx = x + random.uniform(0, 130);
          const double ny = y + random.uniform(0, 80);
          stroke(board, px, py, nx, ny, pen, 2);
          disc(board, nx, ny, 9, pen, 2);
          px = nx;
          py = ny;
        }
        break;
      }
      default:
        outline(board, x, y, 90, 50, pen, 2);
        stroke(board, x + 90, y + 25, x + 130, y + 25, pen, 2);
        outline(board, x + 130, y + 5, 60, 40, pen, 2);
        text(board, made_up_word(random).substr(0, 5), x + 10, y + 32, 12, pen, 2);
    }
  }
  outline(board, 0, 0, w, h, rgb(150, 152, 156), 7);
  fill(board, w * 0.3, h - 9, w * 0.3, 9, rgb(110, 112, 116));
  return board;
}

cv::Mat paint_door_plate(std::uint64_t index, Random& random) {
  cv::Mat plate = canvas(128, 92, rgb(235, 236, 238));
  const Colour accent = any_colour(random);
  fill(plate, 0, 0, 128, 22, accent);
  text(plate, std::to_string(index % 1000), 10, 58, 26, rgb(30, 30, 34), 2);
  text(plate, made_up_word(random), 10, 80, 10, rgb(60, 60, 66));
  outline(plate, 0, 0, 128, 92, rgb(120, 122, 126), 3);
  return plate;
}

cv::Mat paint_sign(Random& random) {
  const Colour colour = Hsv{random.uniform(0, 360), random.uniform(0.5, 0.95), random.uniform(0.3, 0.75)};
  cv::Mat sign = canvas(200, 100, colour);
  const Colour white = rgb(248, 248, 244);
  text(sign, made_up_word(random), 62, 46, 16, white, 2);
  text(sign, made_up_word(random), 62, 80, 13, white, 1);
  const double x = 32;
  switch (random.below(4)) {
    case 0:
      stroke(sign, x - 18, 50, x + 18, 50, white, 6);
      stroke(sign, x + 4, 34, x + 18, 50, white, 6);
      stroke(sign, x + 4, 66, x + 18, 50, white, 6);
      break;
    case 1:
      disc(sign, x, 50, 18, white, 5);
      break;
    case 2:
      fill(sign, x - 16, 34, 32, 32, white);
      break;
    default:
      disc(sign, x, 34, 8, white);
      fill(sign, x - 8, 44, 16, 32, white);
  }
  return sign;
}

cv::Mat paint_exit_sign(Random& random) {
  const Colour green = random.chance(0.6) ? rgb(20, 140, 70) : rgb(190, 40, 40);
  cv::Mat sign = canvas(220, 100, green);
  const Colour white = rgb(250, 252, 248);
  text(sign, "EXIT", 84, 68, 34, white, 4);
  disc(sign, 36, 26, 8, white);
  stroke(sign, 36, 38, 30, 62, white, 8);
  stroke(sign, 30, 62, 14, 82, white, 6);
  stroke(sign, 30, 62, 50, 84, white, 6);
  stroke(sign, 36, 42, 56, 54, white, 5);
  outline(sign, 0, 0, 220, 100, white, 4);
  return sign;
}

cv::Mat paint_clock(Random& random) {
  cv::Mat clock = clear_canvas(128, 128, rgb(60, 60, 60));
  disc(clock, 64, 64, 61, random.chance(0.5) ? rgb(30, 30, 32) : any_colour(random));
  disc(clock, 64, 64, 53, rgb(246, 246, 242));
  for (int i = 0; i < 12; ++i) {
    stroke(clock, 64 + 40 * cos_deg(30 * i), 64 + 40 * sin_deg(30 * i), 64 + 49 * cos_deg(30 * i),
           64 + 49 * sin_deg(30 * i), rgb(20, 20, 20), i % 3 ? 2 : 5);
  }
  const double hour = random.uniform(0, 360);
  stroke(clock, 64, 64, 64 + 26 * cos_deg(hour), 64 + 26 * sin_deg(hour), rgb(20, 20, 20), 6);
  stroke(clock, 64, 64, 64 + 42 * cos_deg(hour * 12), 64 + 42 * sin_deg(hour * 12), rgb(20, 20, 20), 4);
  return clock;
}

cv::Mat paint_extinguisher() {
  cv::Mat c = clear_canvas(80, 220, rgb(150, 30, 30));
  fill(c, 14, 60, 52, 156, rgb(186, 26, 28));
  disc(c, 40, 62, 26, rgb(186, 26, 28));
  fill(c, 20, 60, 8, 150, rgb(226, 96, 90));
  fill(c, 18, 108, 44, 56, rgb(240, 236, 226));
  fill(c, 22, 114, 36, 10, rgb(40, 40, 44));
  fill(c, 22, 130, 30, 4, rgb(60, 60, 66));
  fill(c, 22, 140, 34, 4, rgb(60, 60, 66));
  fill(c, 22, 150, 26, 4, rgb(60, 60, 66));
  fill(c, 30, 22, 20, 20, rgb(30, 30, 32));
  fill(c, 18, 14, 46, 9, rgb(40, 40, 42));
  stroke(c, 62, 22, 70, 120, rgb(26, 26, 28), 7);
  return c;
}

cv::Mat paint_hose_box(Random& random) {
  cv::Mat c = canvas(200, 250, rgb(192, 34, 34));
  outline(c, 0, 0, 200, 250, rgb(120, 18, 20), 6);
  outline(c, 20, 20, 160, 150, rgb(235, 225, 220), 4);
  disc(c, 100, 95, 52, rgb(240, 236, 230), 9);
  disc(c, 100, 95, 30, rgb(240, 236, 230), 6);
  stroke(c, 140, 130, 168, 158, rgb(240, 236, 230), 8);
  text(c, "FIRE", 46, 218, 28, rgb(250, 246, 240), 3);
  fill(c, 176, 180, 12, 26, rgb(60, 60, 60));
  add_noise(c, 40, 5, random.next());
  return c;
}

cv::Mat paint_window(Random& random) {
  const int w = 448;
  const int h = 390;
  const double hue = random.uniform(195, 225);
  cv::Mat view = canvas(w, h, rgb(200, 220, 240));
  vertical_gradient(view, Hsv{hue, random.uniform(0.1, 0.45), 0.98}, Hsv{hue, 0.08, 0.98});
  const int buildings = random.between(3, 6);
  for (int i = 0; i < buildings; ++i) {
    const double bw = random.uniform(60, 150);
    const double bh = random.uniform(90, 260);
    const double x = random.uniform(-20, w - 40);
    const Colour wall = Hsv{random.uniform(0, 360), random.uniform(0.05, 0.35), random.uniform(0.5, 0.85)};
    fill(view, x, h - bh, bw, bh, wall);
    const double step_x = random.uniform(14, 24);
    const double step_y = random.uniform(18, 30);
    for (double y = h - bh + 10; y < h - 20; y += step_y) {
      for (double wx = x + 7; wx < x + bw - step_x * 0.6; wx += step_x) {
        fill(view, wx, y, step_x * 0.5, step_y * 0.5, random.chance(0.8) ? scaled(wall, 0.5) : rgb(240, 230, 180));
      }
    }
  }
  const int crowns = random.between(3, 9);
  for (int i = 0; i < crowns; ++i) {
    const double x = random.uniform(0, w);
    const double y = h - random.uniform(10, 90);
    const Colour green = Hsv{random.uniform(70, 130), random.uniform(0.3, 0.6), random.uniform(0.3, 0.6)};
    stroke(view, x, y, x, h, rgb(90, 70, 50), 6);
    for (int k = 0; k < 14; ++k) {
      const double dx = random.uniform(-34, 34);
      const double dy = random.uniform(-30, 26);
      const double radius = random.uniform(6, 16);
      disc(view, x + dx, y + dy, radius, scaled(green, random.uniform(0.75, 1.3)));
    }
  }
  return view;
}

}  // namespace

cv::Mat paint_wall_thing(Design design, std::uint64_t index, Random& random, Random& notices) {
  switch (design) {
    case Design::kNoticeBoard:
      return paint_notice_board(random);
    case Design::kWhiteboard:
      return paint_whiteboard(random);
    case Design::kDoor:
      return paint_door(random, notices);
    case Design::kDoorPlate:
      return paint_door_plate(index, random);
    case Design::kSign:
      return paint_sign(random);
    case Design::kExitSign:
      return paint_exit_sign(random);
    case Design::kClock:
      return paint_clock(random);
    case Design::kSheet: {
      cv::Mat c = canvas(84, 120, random.chance(0.7) ? rgb(246, 246, 240) : Hsv{random.uniform(0, 360), 0.35, 0.95});
      const double head = random.uniform(8, 18);
      const double head_width = random.uniform(30, 66);
      fill(c, 8, 9, head_width, head, any_colour(random));
      if (random.chance(0.5)) {
        const double h = random.uniform(24, 44);
        fill(c, 8, 34, 68, h, any_colour(random));
        const double x = random.uniform(20, 60);
        disc(c, x, 34 + h / 2, h * 0.3, any_colour(random));
        print_lines(c, 8, 42 + h, 68, 70 - h, 8, rgb(50, 50, 56), random);
      } else {
        print_lines(c, 8, 36, 68, 78, 8, rgb(50, 50, 56), random);
      }
      return c;
    }
    case Design::kSocket: {
      cv::Mat c = canvas(96, 40, rgb(238, 238, 232));
      for (int i = 0; i < 2; ++i) {
        disc(c, 25 + 46 * i, 20, 15, rgb(190, 190, 184));
        disc(c, 19 + 46 * i, 20, 3, rgb(40, 40, 40));
        disc(c, 31 + 46 * i, 20, 3, rgb(40, 40, 40));
      }
      outline(c, 0, 0, 96, 40, rgb(140, 140, 136), 2);
      return c;
    }
    case Design::kGrille: {
      cv::Mat c = canvas(144, 80, rgb(190, 192, 192));
      for (int i = 0; i < 8; ++i) fill(c, 8, 8 + i * 8.5, 128, 4, rgb(70, 72, 76));
      outline(c, 0, 0, 144, 80, rgb(150, 152, 152), 4);
      return c;
    }
    case Design::kExtinguisher:
      return paint_extinguisher();
    case Design::kHoseBox:
      return paint_hose_box(random);
    case Design::kWindow:
      return paint_window(random);
    default: {
      cv::Mat c = canvas(40, 72, rgb(236, 236, 230));
      outline(c, 0, 0, 40, 72, rgb(150, 150, 146), 3);
      fill(c, 12, 12, 16, 22, rgb(206, 206, 200));
      disc(c, 20, 54, 9, rgb(120, 120, 116));
      return c;
    }
  }
}

}  // namespace mapweld::rendered
