#pragma once

#include <QFontMetricsF>
#include <QPolygonF>
#include <QQuickPaintedItem>
#include <QRectF>
#include <optional>
#include <vector>

#include "interaction/tablet/window/screen_model.hpp"

namespace usher::tablet {

/// Building, places, route and destination; painted only when one of them changes. The robot is an
/// item of its own, so that it can move without painting. Names of places keep off each other, the
/// route that the robot drives, and off `robotArea` and `hereArea` [px of this item].
class FloorPlanItem : public QQuickPaintedItem {
  Q_OBJECT
  QML_ELEMENT
  Q_PROPERTY(usher::tablet::ScreenModel* screen READ screen WRITE set_screen NOTIFY screenChanged)
  Q_PROPERTY(double textSize MEMBER text_size_ NOTIFY textSizeChanged)
  Q_PROPERTY(QRectF robotArea READ robot_area WRITE set_robot_area NOTIFY areasChanged)
  Q_PROPERTY(QRectF hereArea READ here_area WRITE set_here_area NOTIFY areasChanged)

 public:
  explicit FloorPlanItem(QQuickItem* parent = nullptr);
  ScreenModel* screen() const { return screen_; }
  void set_screen(ScreenModel* screen);
  QRectF robot_area() const { return robot_area_; }
  void set_robot_area(const QRectF& area) { keep_off(robot_area_, area); }
  QRectF here_area() const { return here_area_; }
  void set_here_area(const QRectF& area) { keep_off(here_area_, area); }
  void paint(QPainter* painter) override;
  /// Where names of places were written last; they do not overlap, and cover no place.
  const std::vector<QRectF>& labels() const { return labels_; }
  const std::vector<QPointF>& places() const { return places_; }

 signals:
  void screenChanged();
  void textSizeChanged();
  void areasChanged();

 private:
  struct Name {
    QString text;  ///< in one line or two
    QRectF box;
  };
  void keep_off(QRectF& area, const QRectF& now);
  QPolygonF route(double scale) const;
  bool free(const QRectF& box, const QPolygonF& route) const;
  std::optional<Name> room_for(const QString& name, const QPointF& at, double radius,
                               const QFontMetricsF& metrics, const QPolygonF& route) const;
  void paint_route(QPainter* painter, const QPolygonF& route) const;
  void paint_places(QPainter* painter, double scale, const QPolygonF& route);

  ScreenModel* screen_ = nullptr;
  double text_size_ = 20.0;
  QRectF robot_area_, here_area_;
  std::vector<QRectF> labels_;
  std::vector<QPointF> places_;
};

}  // namespace usher::tablet
