#pragma once

#include <QFontMetricsF>
#include <QPointF>
#include <QQuickPaintedItem>
#include <QRectF>
#include <QSizeF>
#include <vector>

#include "interaction/tablet/core/place_names.hpp"
#include "interaction/tablet/window/screen_model.hpp"

namespace usher::tablet {

/// [px] of the dot of a place.
inline double dot_radius(bool marked, double text_size) {
  return text_size * (marked ? 0.35 : 0.12);
}

/// The names of places over a FloorPlanItem of the same size. Where they stand is chosen once for a
/// view of the map: its page, its size, the building, the places (which have the names of a
/// language), the one that is marked; not for a route, nor for a robot that moves: it drives below
/// them. Where the map tells where the robot is, they leave room to it as that page opens. Its sign
/// (`signSize`) keeps off them: it belongs at `signPosition`.
class PlaceNamesItem : public QQuickPaintedItem {
  Q_OBJECT
  QML_ELEMENT
  Q_PROPERTY(usher::tablet::ScreenModel* screen READ screen WRITE set_screen NOTIFY screenChanged)
  Q_PROPERTY(double textSize READ text_size WRITE set_text_size NOTIFY textSizeChanged)
  Q_PROPERTY(QPointF robot READ robot WRITE set_robot NOTIFY robotChanged)
  Q_PROPERTY(double robotReach MEMBER robot_reach_ NOTIFY robotChanged)
  Q_PROPERTY(QSizeF signSize READ sign_size WRITE set_sign_size NOTIFY robotChanged)
  Q_PROPERTY(QPointF signPosition READ sign_position NOTIFY signPositionChanged)

 public:
  struct Name {
    QString text;  ///< in one line or two
    NameBox stands;
    bool marked = false;
    QRectF box() const;
  };

  explicit PlaceNamesItem(QQuickItem* parent = nullptr);
  ScreenModel* screen() const { return screen_; }
  void set_screen(ScreenModel* screen);
  double text_size() const { return text_size_; }
  void set_text_size(double size);
  QPointF robot() const { return robot_; }
  void set_robot(const QPointF& robot);
  QSizeF sign_size() const { return sign_size_; }
  void set_sign_size(const QSizeF& size);
  QPointF sign_position() const { return sign_position_; }
  void paint(QPainter* painter) override;
  const std::vector<Name>& names() const { return names_; }
  std::vector<QPointF> places() const;

 signals:
  void screenChanged();
  void textSizeChanged();
  void robotChanged();
  void signPositionChanged();

 protected:
  void geometryChange(const QRectF& now, const QRectF& before) override;
  void itemChange(ItemChange change, const ItemChangeData& data) override;
  void updatePolish() override;

 private:
  double scale() const;
  QFont letters() const;
  Sign sign(const std::vector<Box>& names) const;
  void place_sign();

  ScreenModel* screen_ = nullptr;
  double text_size_ = 20.0, robot_reach_ = 0.0;
  QPointF robot_, sign_position_;
  QSizeF sign_size_;
  Side sign_side_ = Side::kAbove;
  std::vector<Name> names_;
};

}  // namespace usher::tablet
